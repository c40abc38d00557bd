#include "apps/bridge/bridge_options.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "io/files/errors.hpp"
#include "io/files/number_text.hpp"
#include "io/files/text_file.hpp"
#include "io/inputs/mounting_text.hpp"
#include "io/messages/image_topics.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMaxConfig_bytes = std::size_t{1} << 20;

bool isFrameId(std::string_view name) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '/' || c == '-';
  };
  return !name.empty() && !name.starts_with('/') && std::ranges::all_of(name, plain);
}

bool isTopic(std::string_view name) {
  const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '/'; };
  return name.size() > 1 && name.starts_with('/') && !name.ends_with('/') && std::ranges::all_of(name, plain);
}

}  // namespace

std::optional<double> speedOf(const BridgeOptions& options, double capture_rate_hz) {
  if (options.rate.empty()) return 1;
  if (options.rate == "max") {
    if (options.live) throw UsageError("--rate max: a live camera has a rate; give one in Hz");
    return std::nullopt;
  }
  const auto rate_hz = numberIn(options.rate);
  if (!rate_hz || *rate_hz <= 0)
    throw UsageError("--rate " + options.rate + ": write max or a positive number of pairs per second");
  return capture_rate_hz > 0 ? *rate_hz / capture_rate_hz : 1;
}

FrameIds frameIdsOf(const BridgeOptions& options) {
  if (options.frame_ids.empty()) return {.world = "odom", .child = options.mounting.empty() ? "camera" : "base_link"};
  const auto comma = options.frame_ids.find(',');
  FrameIds ids{.world = options.frame_ids.substr(0, comma),
               .child = comma == std::string::npos ? "" : options.frame_ids.substr(comma + 1)};
  if (!isFrameId(ids.world) || !isFrameId(ids.child) || ids.world == ids.child)
    throw UsageError("--frame-ids " + options.frame_ids +
                     ": write WORLD,CHILD, two different names of letters, digits, _, - and /, which is not the first");
  return ids;
}

SE3 mountingOf(const BridgeOptions& options) {
  return options.mounting.empty() ? SE3() : parseMounting(options.mounting);
}

std::string vehicleMotionTopicOf(const BridgeOptions& options) {
  if (options.vehicle_motion.empty() || isTopic(options.vehicle_motion)) return options.vehicle_motion;
  throw UsageError("--vehicle-motion " + printable(options.vehicle_motion) +
                   ": write a topic, as /vehicle/twist_with_covariance");
}

std::array<CameraTopics, 2> cameraTopicsOf(const BridgeOptions& options) {
  const auto comma = options.images.find(',');
  const std::string left = options.images.substr(0, comma);
  const std::string right = comma == std::string::npos ? "" : options.images.substr(comma + 1);
  if (!isTopic(left) || !isTopic(right) || left == right)
    throw UsageError("--images " + printable(options.images) +
                     ": write LEFT,RIGHT, the topics of the two cameras' images, as "
                     "/left/image_raw,/right/image_raw");
  if (!options.given.empty()) return {CameraTopics{.image = left}, CameraTopics{.image = right}};
  std::array topics{CameraTopics{.image = left, .info = cameraInfoTopicOf(left)},
                    CameraTopics{.image = right, .info = cameraInfoTopicOf(right)}};
  if (topics[0].info == topics[1].info)
    throw UsageError("--images: " + topics[0].info +
                     " would be the camera_info of both; give --camera or --calibration");
  return topics;
}

Tracker::Options trackerOptionsOf(const BridgeOptions& options) {
  Tracker::Options tracker;
  const bool live = options.images.empty() ? options.live : !options.every_pair;
  tracker.policy = live ? Tracker::Policy::kLive : Tracker::Policy::kReplay;
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
