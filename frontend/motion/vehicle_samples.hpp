#pragma once

#include <optional>
#include <vector>

#include "core/vehicle_motion.hpp"

namespace motorcade {

/// Samples of the vehicle's own motion by time, as they come: at a rate of their own, late, out of order, with gaps.
class VehicleSamples {
 public:
  /// Adds a sample. One with an earlier one's stamp, or that is not finite, is left out.
  void add(const VehicleMotionSample& sample);
  void forgetBefore(Timestamp stamp);

  /// A part of a span over which speed and yaw rate are taken as constant.
  struct Piece {
    double dt_s, speed_mps, yaw_rate_radps;
    double speed_sigma_mps, yaw_rate_sigma_radps;  // as told, 0 where they are not
    double unknown_s = 0;                          // from the samples beside it, where these are farther than usual
  };
  /// Cuts the span at the samples; each piece has the mean of its ends. Before the first and after the last sample,
  /// values are held for a while. Speeds that no vehicle reaches from the sample before are passed over, as those of a
  /// spinning wheel. Empty where samples are missing.
  std::optional<std::vector<Piece>> between(Timestamp from, Timestamp to) const;

 private:
  std::vector<VehicleMotionSample> believable(Timestamp from, Timestamp to) const;

  std::vector<VehicleMotionSample> samples_;  // by stamp
};

}  // namespace motorcade
