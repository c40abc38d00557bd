#pragma once

#include <array>
#include <optional>

#include "apps/bridge/bridge_command.hpp"
#include "apps/bridge/messages/message_conversion.hpp"
#include "apps/bridge/messages/received_image.hpp"
#include "motorcade/motorcade.hpp"

/// Interprets the command line of `motorcade bridge`. All functions throw UsageError.
namespace motorcade {

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

}  // namespace motorcade
