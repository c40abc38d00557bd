#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <fstream>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "apps/bridge/bridge_command.hpp"
#include "apps/bridge/bridge_parts.hpp"
#include "apps/bridge/dds/dds_publisher.hpp"
#include "apps/bridge/dds/image_subscriber.hpp"
#include "apps/bridge/input_watch.hpp"
#include "apps/bridge/messages/message_conversion.hpp"
#include "apps/bridge/topic_feeder.hpp"
#include "apps/console/log.hpp"
#include "apps/console/progress.hpp"
#include "apps/console/stop_signals.hpp"
#include "apps/interface/camera_model.hpp"

namespace motorcade {
namespace {

using namespace std::chrono_literals;

/// Publishes the status of the input, each second, also while no results come.
class InputReport {
 public:
  InputReport(DdsPublisher& out, const TopicFeeder& feeder, std::string hardware_id)
      : out_(out), feeder_(feeder), hardware_id_(std::move(hardware_id)) {}

  void publishWhenDue() {
    const auto now = std::chrono::steady_clock::now();
    if (now < due_ || !out_.publishes(Topic::kDiagnostics)) return;
    due_ = now + 1s;
    const std::chrono::nanoseconds wall_clock = std::chrono::system_clock::now().time_since_epoch();
    out_.publish(ros::DiagnosticArray{.header = {.stamp = timeOf(wall_clock.count())},
                                      .status = {inputStatusOf(feeder_.counts(), feeder_.problem(), hardware_id_)}});
  }

 private:
  DdsPublisher& out_;
  const TopicFeeder& feeder_;
  std::string hardware_id_;
  std::chrono::steady_clock::time_point due_{};
};

/// False when asked to stop before the cameras were known.
bool awaitCameras(TopicFeeder& feeder, InputReport& report, const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    if (feeder.awaitCameras(100ms)) return true;
    report.publishWhenDue();
  }
  return false;
}

/// Publishes the tracker's results until the feeder ends.
void follow(Tracker& tracker, TopicFeeder& feeder, ResultPublisher results, InputReport& report,
            std::stop_source& stop) {
  std::exception_ptr failure;
  Progress progress("frame", 0);
  {
    const std::jthread feeding([&, token = stop.get_token()] {
      try {
        feeder.feed(tracker, token);
      } catch (...) {
        failure = std::current_exception();
        tracker.close();
      }
    });
    try {
      for (std::size_t done = 0; !tracker.done(); report.publishWhenDue()) {
        const auto result = tracker.wait(100ms);
        if (!result) continue;
        results.publish(*result);
        progress.show(++done, fmt::format("latency {:.1f} ms", result->latency_ms));
      }
    } catch (...) {
      stop.request_stop();  // else the feeder would go on
      throw;
    }
  }
  if (failure) std::rethrow_exception(failure);
}

void tellFollowed(const InputCounts& input, const Tracker::Counts& tracker) {
  logInfo(fmt::format("{} pairs; {} dropped by a newer one, {} overtaken before they were converted", input.pairs,
                      tracker.dropped, input.overtaken));
  if (input.unpaired[0] + input.unpaired[1] > 0)
    logInfo(fmt::format("{} left and {} right images had no partner", input.unpaired[0], input.unpaired[1]));
  if (input.unreadable > 0) logWarning(fmt::format("{} pairs could not be read", input.unreadable));
  if (input.rejected > 0)
    logWarning(fmt::format("{} pairs were rejected: of another size, or without a later stamp", input.rejected));
}

/// Debian's default holds no image.
void tellSmallReceiveBuffer() {
  constexpr std::int64_t kLeast_bytes = 1 << 20;
  std::int64_t most_bytes = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> most_bytes;
  if (most_bytes <= 0 || most_bytes >= kLeast_bytes) return;
  logWarning(
      fmt::format("net.core.rmem_max is {} bytes: parts of images may be lost; as root: sysctl -w "
                  "net.core.rmem_max=33554432",
                  most_bytes));
}

TopicFeeder::Params feederParamsOf(const BridgeOptions& options) {
  return {.cameras = {.topics = cameraTopicsOf(options), .given = options.given},
          .tolerance_ns = std::llround(1e6 * options.pair_within_ms),
          .most_pairs = options.pairs,
          .every_pair = options.every_pair};
}

}  // namespace

int runTopicBridge(const BridgeOptions& options) {
  const auto topics = topicsOf(options.topics);
  const TopicFeeder::Params input = feederParamsOf(options);
  const ResultPublisher::Params published{
      .ids = frameIdsOf(options), .T_child_cam = mountingOf(options), .drive = options.images, .marker_lifetime_s = 1};
  Tracker::Options tracker_options = trackerOptionsOf(options);
  tracker_options.log = logToSpdlog;
  const DdsPlace place{.domain = options.domain, .interface = options.interface};
  StopSignals signals;  // before all threads
  DdsPublisher out(place, topics);
  ImageSubscriber images(place, {.topics = input.cameras.topics,
                                 .vehicle_motion = vehicleMotionTopicOf(options),
                                 .every_image = options.every_pair});
  tellPlace(out, place, topics);
  tellSmallReceiveBuffer();

  std::stop_source stop;
  const auto watch = signals.watch([&stop] { stop.request_stop(); });
  awaitSubscribers(out, options, stop.get_token());
  TopicFeeder feeder(images, input);
  InputReport report(out, feeder, options.images);
  if (awaitCameras(feeder, report, stop.get_token())) {
    const Sequence& cameras = feeder.cameras();
    const auto tracker =
        makeTracker(cameraOf(cameras.camera, cameras.calibration.sigmas), tracker_options, options, options.images);
    follow(*tracker, feeder, {out, published}, report, stop);
    tellFollowed(feeder.counts(), tracker->counts());
  }
  tellPublished(out.counts());
  return signals.received() == 0 ? 0 : kExitSignal + signals.received();
}

}  // namespace motorcade
