#pragma once

#include <cstdint>
#include <optional>

#include "core/messages.hpp"
#include "frontend/motion/vehicle_calibration.hpp"
#include "frontend/motion/vehicle_samples.hpp"

namespace motorcade {

/// Camera motion by the vehicle's own sensors. They are believed until they contradict the camera in several frames,
/// and again when they have agreed with it for a while. Call it in frame order.
class VehicleOdometry {
 public:
  /// Takes the samples that came with the frame of this time. If the camera's clock was set back, and that of the
  /// samples with it, their stamps follow.
  void hear(const FrameInputs& inputs, Timestamp frame);
  /// Motion between two moments; empty where samples are missing, or are not believed.
  std::optional<UncertainMotion> motion(Timestamp from, Timestamp to) const;
  /// The same where images tell nothing. The speed of wheels that slip is believed, too, for a while: a wrong one is
  /// better than none. Its deviation is its last error.
  std::optional<UncertainMotion> motionUnseen(Timestamp from, Timestamp to) const;
  /// Compares the sensors with a motion that the camera measured, from one frame to the next.
  void compare(Timestamp from, Timestamp to, const UncertainMotion& seen);
  /// Notes that hardly a point agrees with the sensors, where vehicles around the camera may be why.
  void dispute();
  /// Forgets samples before this moment, which are not asked for any more.
  void forgetBefore(Timestamp stamp) { samples_.forgetBefore(stamp); }

  /// Findings about the sensors; empty while there were no samples.
  std::optional<VehicleSensors> sensors() const;

 private:
  void judge(bool agrees);
  bool slipsLately() const;

  VehicleSamples samples_;
  VehicleCalibration calibration_;
  std::uint64_t heard_ = 0;
  std::int64_t ahead_ns_ = 0;  // from the samples' clock to the frames' time
  double agreement_ = 0.9;     // share of the last frames in which they agreed with the camera
  VehicleSensors::Motion told_, seen_;
  std::optional<double> slip_mps_;  // error of the speed in the last frame, where it may be by slip
  int agreed_ = 0;                  // frames in which they agreed, in all
  int disputed_ = 0;                // frames since they agreed
  bool believed_ = true;
};

}  // namespace motorcade
