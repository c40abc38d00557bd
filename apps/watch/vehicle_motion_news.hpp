#pragma once

#include <optional>
#include <string>

#include "core/messages.hpp"

namespace motorcade {

/// Reports when the vehicle's own motion is left out, as it contradicts the camera, and when it is used again.
class VehicleMotionNews {
 public:
  /// Takes the frames in order. Returns a sentence when there is something to report, no more than a few per drive.
  std::optional<std::string> observe(const FrameMeasurements& frame);

  /// The newest findings; empty where there are no such sensors.
  const std::optional<VehicleSensors>& sensors() const { return sensors_; }
  /// Frames in which they were left out.
  int leftOut() const { return left_out_; }

 private:
  std::optional<VehicleSensors> sensors_;
  int left_out_ = 0, told_ = 0;
};

}  // namespace motorcade
