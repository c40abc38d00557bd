#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "apps/bridge/bridge_command.hpp"
#include "apps/bridge/dds/dds_publisher.hpp"
#include "apps/bridge/messages/message_conversion.hpp"
#include "apps/bridge/messages/object_messages.hpp"
#include "apps/bridge/messages/pair_conversion.hpp"
#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"

/// The parts of the bridge that drives and topics share.
namespace motorcade {

// What the command line of `motorcade bridge` means. All functions throw UsageError.

/// Captured seconds per second; empty for as fast as possible. `capture_rate_hz` is 0 where it is not known.
std::optional<double> speedOf(const BridgeOptions& options, double capture_rate_hz);

/// Two different names that tf2 accepts. The defaults are `odom` and `camera`, or `base_link` where the camera's
/// mounting is given.
FrameIds frameIdsOf(const BridgeOptions& options);

/// T_vehicle_cam, both frames with the axes of REP 103. The camera is turned by roll, then pitch, then yaw about the
/// vehicle's axes. The identity without a mounting.
SE3 mountingOf(const BridgeOptions& options);

/// Empty where there is none.
std::string vehicleMotionTopicOf(const BridgeOptions& options);

/// The topics of `--images LEFT,RIGHT`; no camera_info where the user gives the cameras.
std::array<CameraTopics, 2> cameraTopicsOf(const BridgeOptions& options);

/// The tracker's options, with the file of parameters read. The caller reports the tracker's remarks on them.
Tracker::Options trackerOptionsOf(const BridgeOptions& options);

// The tracker, and what the user is told.

/// The tracker's log.
void logToSpdlog(Tracker::LogLevel level, const std::string& text);

/// The public interface's error, without the name of the field: users know files and options.
std::string textOf(const Error& error);

/// Throws UserError; `input` names the source of the camera.
std::unique_ptr<Tracker> makeTracker(const Camera& camera, const Tracker::Options& tracker_options,
                                     const BridgeOptions& options, const std::string& input);

void tellPlace(const DdsPublisher& out, const DdsPlace& place, const std::set<Topic>& topics);
void tellPublished(const std::vector<DdsPublisher::Counts>& topics);

/// Waits for the options' number of subscribers, up to the options' time.
void awaitSubscribers(const DdsPublisher& out, const BridgeOptions& options, const std::stop_token& stop);

/// Turns the results of one tracker into the requested messages, and publishes them. Call it in frame order.
class ResultPublisher {
 public:
  struct Params {
    FrameIds ids{};
    SE3 T_child_cam{};    // where the camera sits in what `ids.child` names
    std::string drive{};  // in diagnostics, the hardware's name
    double marker_lifetime_s = 1;
  };
  ResultPublisher(DdsPublisher& out, const Params& params);
  void publish(const Result& result);

 private:
  DdsPublisher& out_;
  Params params_;
  ObjectMarkers markers_;
  std::optional<std::int64_t> first_stamp_ns_{};
};

}  // namespace motorcade
