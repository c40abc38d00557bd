#include "backend/make_backend.hpp"

#include <initializer_list>
#include <stdexcept>
#include <string>

namespace motorcade {
namespace {

struct Named {
  const char* name;
  double value;
};

void requirePositive(std::initializer_list<Named> parameters) {
  for (const auto& [name, value] : parameters)
    if (!(value > 0)) throw std::invalid_argument(std::string("backend: ") + name + " must be positive");
}

void requireNotNegative(std::initializer_list<Named> parameters) {
  for (const auto& [name, value] : parameters)
    if (!(value >= 0)) throw std::invalid_argument(std::string("backend: ") + name + " must not be negative");
}

void check(const Optimizer::Params& p) {
  requirePositive({{"encounter_loss_scale", p.encounter_loss_scale},
                   {"motion_loss_scale", p.motion_loss_scale},
                   {"odometry_variance_scale", p.odometry_variance_scale},
                   {"encounter_variance_scale", p.encounter_variance_scale},
                   {"motion_variance_scale", p.motion_variance_scale},
                   {"first_pose_sigma_m", p.first_pose_sigma_m},
                   {"first_pose_sigma_rad", p.first_pose_sigma_rad},
                   {"object_origin_sigma_m", p.object_origin_sigma_m},
                   {"object_origin_sigma_rad", p.object_origin_sigma_rad},
                   {"anchor_sigma_m", p.anchor_sigma_m},
                   {"anchor_sigma_rad", p.anchor_sigma_rad},
                   {"acceleration_along_mps2", p.acceleration_along_mps2},
                   {"acceleration_sideways_mps2", p.acceleration_sideways_mps2},
                   {"acceleration_vertical_mps2", p.acceleration_vertical_mps2},
                   {"acceleration_yaw_radps2", p.acceleration_yaw_radps2},
                   {"acceleration_tilt_radps2", p.acceleration_tilt_radps2},
                   {"object_encounter_share", p.object_encounter_share},
                   {"relinearize_every_updates", static_cast<double>(p.relinearize_every_updates)},
                   {"iterations_per_update", static_cast<double>(p.iterations_per_update)},
                   {"final_iterations", static_cast<double>(p.final_iterations)},
                   {"camera_covariance_frames", static_cast<double>(p.camera_covariance_frames)}});
  requireNotNegative({{"window_frames", static_cast<double>(p.window_frames)},
                      {"object_correlation_s", p.object_correlation_s},
                      {"object_encounter_distance_m", p.object_encounter_distance_m},
                      {"object_encounter_partners", static_cast<double>(p.object_encounter_partners)},
                      {"mismatch_tolerance", p.mismatch_tolerance},
                      {"jacobian_drift_sigmas", p.jacobian_drift_sigmas},
                      {"substitution_tolerance", p.substitution_tolerance},
                      {"online_correction_s", p.online_correction_s},
                      {"budget_scalars", static_cast<double>(p.budget_scalars)},
                      {"budget_ms", p.budget_ms},
                      {"covariance_lag_frames", static_cast<double>(p.covariance_lag_frames)}});
  if (!(p.object_encounter_share < 1)) throw std::invalid_argument("backend: object_encounter_share must be below 1");
}

void check(const FilterBackend::Params& p) {
  requirePositive({{"acceleration_along_mps2", p.acceleration_along_mps2},
                   {"acceleration_sideways_mps2", p.acceleration_sideways_mps2},
                   {"acceleration_vertical_mps2", p.acceleration_vertical_mps2},
                   {"acceleration_yaw_radps2", p.acceleration_yaw_radps2},
                   {"acceleration_tilt_radps2", p.acceleration_tilt_radps2},
                   {"initial_speed_sigma_mps", p.initial_speed_sigma_mps},
                   {"initial_turn_rate_sigma_radps", p.initial_turn_rate_sigma_radps},
                   {"adaptation_time_s", p.adaptation_time_s},
                   {"innovation_scale", p.innovation_scale}});
}

}  // namespace

std::unique_ptr<Backend> makeBackend(const BackendParams& params) {
  if (params.kind == BackendKind::kFilter) {
    check(params.filter);
    return std::make_unique<FilterBackend>(params.filter);
  }
  check(params.smoother);
  return std::make_unique<Optimizer>(params.smoother);
}

}  // namespace motorcade
