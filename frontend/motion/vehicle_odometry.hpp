#pragma once

#include <cstdint>
#include <optional>

#include "core/messages.hpp"
#include "frontend/motion/vehicle_calibration.hpp"
#include "frontend/motion/vehicle_samples.hpp"

namespace motorcade {

/// The camera's motion as the vehicle's own sensors tell it. They are believed until they contradict the camera in
/// several frames, and again when they have agreed with it for a while. Call it in frame order.
class VehicleOdometry {
 public:
  /// Takes the samples that came with a frame.
  void hear(const FrameInputs& inputs);
  /// The motion between two moments; empty where samples are missing, or are not believed.
  std::optional<UncertainMotion> motion(Timestamp from, Timestamp to) const;
  /// A motion that the camera measured, from one frame to the next.
  void compare(Timestamp from, Timestamp to, const UncertainMotion& seen);
  /// They tell a motion that hardly a point agrees with, but vehicles around the camera may be why.
  void dispute();
  /// Nothing before this moment will be asked for.
  void forgetBefore(Timestamp stamp) { samples_.forgetBefore(stamp); }

  /// Empty while there were no samples.
  std::optional<VehicleSensors> sensors() const;

 private:
  void judge(bool agrees);

  VehicleSamples samples_;
  VehicleCalibration calibration_;
  std::uint64_t heard_ = 0;
  double agreement_ = 0.9;  // share of the last frames in which they agreed with the camera
  VehicleSensors::Motion told_, seen_;
  int disputed_ = 0;  // frames since they agreed
  bool believed_ = true;
};

}  // namespace motorcade
