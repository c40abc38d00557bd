#include "apps/bridge/bridge_command.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <stop_token>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "apps/bridge/bridge_parts.hpp"
#include "apps/bridge/dds/dds_publisher.hpp"
#include "apps/bridge/drive_player.hpp"
#include "apps/console/log.hpp"
#include "apps/console/progress.hpp"
#include "apps/console/stop_signals.hpp"
#include "io/files/errors.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {
namespace {

using namespace std::chrono_literals;

/// The folder's own name, also for the path `.`.
std::string nameOf(const std::filesystem::path& drive) {
  std::error_code unreachable;  // then the name is that which was given
  return std::filesystem::weakly_canonical(drive, unreachable).filename().string();
}

/// A marker outlives three frames, and a second.
double markerLifetime_s(std::optional<double> speed, double capture_rate_hz) {
  constexpr double kLeast_s = 1, kFrames = 3;
  return speed && capture_rate_hz > 0 ? std::max(kLeast_s, kFrames / (*speed * capture_rate_hz)) : kLeast_s;
}

Recording opened(const std::filesystem::path& drive) {
  try {
    return Recording(drive.string());
  } catch (const Error& error) {
    throw InputError(textOf(error));
  }
}

/// Plays the drive once through one tracker. Returns the number of pairs that a newer one replaced.
std::int64_t playOnce(Tracker& tracker, DrivePlayer& player, const DrivePlayer::Pace& pace, ResultPublisher results,
                      Progress& progress, std::stop_source& stop) {
  std::int64_t done = 0;
  const std::jthread feeder([&, token = stop.get_token()] { player.play(tracker, pace, token); });
  try {
    while (!tracker.done()) {
      const auto result = tracker.wait(100ms);
      if (!result) continue;
      results.publish(*result);
      progress.show(static_cast<std::size_t>(++done), fmt::format("latency {:.1f} ms", result->latency_ms));
    }
  } catch (...) {
    stop.request_stop();  // else the feeder would go on to the end of the drive
    throw;
  }
  return tracker.counts().dropped;
}

void tellDriven(const DrivePlayer::Counts& player, std::int64_t dropped) {
  logInfo(fmt::format("{} pairs; {} dropped by a newer one, {} overtaken before they were read", player.pushed, dropped,
                      player.overtaken));
  if (player.rejected > 0)
    logWarning(fmt::format("{} pairs were rejected: damaged, or without a later stamp", player.rejected));
}

}  // namespace

int runBridge(const BridgeOptions& options) {
  if (!options.images.empty()) return runTopicBridge(options);
  const auto topics = topicsOf(options.topics);
  const FrameIds ids = frameIdsOf(options);
  const SE3 T_child_cam = mountingOf(options);
  Tracker::Options tracker_options = trackerOptionsOf(options);
  tracker_options.log = logToSpdlog;
  const DdsPlace place{.domain = options.domain, .interface = options.interface};
  StopSignals signals;  // before all threads
  Recording recording = opened(options.drive);
  auto tracker = makeTracker(recording.camera(), tracker_options, options, options.drive.string());
  DrivePlayer player(recording);
  const DrivePlayer::Pace pace{.speed = speedOf(options, player.captureRate_hz()), .live = options.live};
  const ResultPublisher::Params published{.ids = ids,
                                          .T_child_cam = T_child_cam,
                                          .drive = nameOf(options.drive),
                                          .marker_lifetime_s = markerLifetime_s(pace.speed, player.captureRate_hz())};
  DdsPublisher out(place, topics);
  tellPlace(out, place, topics);

  std::stop_source stop;
  const auto watch = signals.watch([&stop] { stop.request_stop(); });
  awaitSubscribers(out, options, stop.get_token());
  std::int64_t dropped = 0;
  for (bool again = !stop.stop_requested(); again; again = options.loop && !stop.stop_requested()) {
    if (!tracker) tracker = makeTracker(recording.camera(), tracker_options, options, options.drive.string());
    Progress progress("frame", static_cast<std::size_t>(recording.size()));
    dropped += playOnce(*tracker, player, pace, {out, published}, progress, stop);
    tracker.reset();
  }
  tellDriven(player.counts(), dropped);
  tellPublished(out.counts());
  return signals.received() == 0 ? 0 : kExitSignal + signals.received();
}

}  // namespace motorcade
