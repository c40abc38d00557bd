#include "apps/bridge/bridge_options.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>

#include "io/errors.hpp"
#include "io/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMaxConfig_bytes = std::size_t{1} << 20;

bool isFrameId(std::string_view name) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '/' || c == '-';
  };
  return !name.empty() && !name.starts_with('/') && std::ranges::all_of(name, plain);
}

}  // namespace

std::optional<double> speedOf(const BridgeOptions& options, double capture_rate_hz) {
  if (options.rate.empty()) return 1;
  if (options.rate == "max") {
    if (options.live) throw UsageError("--rate max: a live camera has a rate; give one in Hz");
    return std::nullopt;
  }
  const char* const end = options.rate.data() + options.rate.size();
  double rate_hz = 0;
  const auto [read, error] = std::from_chars(options.rate.data(), end, rate_hz);
  if (error != std::errc() || read != end || !std::isfinite(rate_hz) || rate_hz <= 0)
    throw UsageError("--rate " + options.rate + ": write max or a positive number of pairs per second");
  return capture_rate_hz > 0 ? rate_hz / capture_rate_hz : 1;
}

FrameIds frameIdsOf(const BridgeOptions& options) {
  const auto comma = options.frame_ids.find(',');
  FrameIds ids{.world = options.frame_ids.substr(0, comma),
               .child = comma == std::string::npos ? "" : options.frame_ids.substr(comma + 1)};
  if (!isFrameId(ids.world) || !isFrameId(ids.child) || ids.world == ids.child)
    throw UsageError("--frame-ids " + options.frame_ids +
                     ": write WORLD,CHILD, two different names of letters, digits, _, - and /, which is not the first");
  return ids;
}

Tracker::Options trackerOptionsOf(const BridgeOptions& options) {
  Tracker::Options tracker;
  tracker.policy = options.live ? Tracker::Policy::kLive : Tracker::Policy::kReplay;
  tracker.axes = Tracker::Axes::kRep103;
  tracker.threads = options.threads;
  if (options.config.empty()) return tracker;
  try {
    tracker.settings = readWhole(options.config, kMaxConfig_bytes);
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
  return tracker;
}

}  // namespace motorcade
