#pragma once

#include <memory>

#include "backend/backend.hpp"

namespace motorcade {

/// The paper's baseline: odometry is chained, and every object has a constant-velocity extended Kalman filter of its
/// own (pose and body twist, on its encounters). Frames are final as soon as they are published.
class FilterBackend final : public Backend {
 public:
  struct Params {
    /// White noise on acceleration, as a spectral density: standard deviation of the velocity's change after one
    /// second.
    double acceleration_along_mps2 = 2.0, acceleration_sideways_mps2 = 0.5, acceleration_vertical_mps2 = 0.3;
    double acceleration_yaw_radps2 = 0.3, acceleration_tilt_radps2 = 0.1;
    double initial_speed_sigma_mps = 10.0, initial_turn_rate_sigma_radps = 0.3;
    /// Scales the process noise of each object so that its normalized innovation squared stays near 1 per dimension.
    bool adapt_process_noise = true;
    double adaptation_time_s = 2.0;
    /// Innovations beyond this many sigma are weighted down (Huber).
    double innovation_scale = 3.0;
  };

  explicit FilterBackend(const Params& params);
  ~FilterBackend() override;

  EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) override;
  std::vector<FrameEstimate> finish() override;

  /// Mean normalized innovation squared per dimension, over all objects so far: 1 when the noise is well tuned.
  double meanNormalizedInnovation() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace motorcade
