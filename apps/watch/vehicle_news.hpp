#pragma once

#include <optional>
#include <string>

#include "core/messages.hpp"

namespace motorcade {

/// "fills 19 % of the left image (columns 0 to 1241, rows 304 to 374)": the end of a sentence after its subject.
std::string placeOf(const OwnVehicleView& view);

/// Reports the own vehicle once: two seconds after its first part was found, as it grows meanwhile.
class OwnVehicleNews {
 public:
  /// Takes the frames in order. Returns a sentence when there is something to report.
  std::optional<std::string> observe(const FrameMeasurements& frame);
  /// Returns the sentence that was not reported yet; no further frame comes.
  std::optional<std::string> finish();

  /// The latest view of the own vehicle; empty while none was found.
  const std::optional<OwnVehicleView>& view() const { return view_; }

 private:
  std::optional<Timestamp> found_;
  std::optional<OwnVehicleView> view_;
  bool told_ = false;
};

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
