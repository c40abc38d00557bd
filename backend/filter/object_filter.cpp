#include "backend/filter/object_filter.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"
#include "core/robust_loss.hpp"

namespace motorcade {

ObjectFilter::ObjectFilter(const Params& params, Timestamp stamp, const SE3& T_world_body, const Matrix6d& covariance)
    : params_(params), stamp_(stamp), state_{.T_world_body = T_world_body, .covariance = Matrix12d::Zero()} {
  Matrix12d& P = state_.covariance;
  P.topLeftCorner<6, 6>() = covariance;
  P.diagonal().segment<3>(6).setConstant(params.initial_speed_sigma_mps * params.initial_speed_sigma_mps);
  P.diagonal().tail<3>().setConstant(params.initial_turn_rate_sigma_radps * params.initial_turn_rate_sigma_radps);
}

void ObjectFilter::predict(Timestamp stamp) {
  dt_s_ = secondsBetween(stamp_, stamp);
  if (!(dt_s_ > 0)) return;
  stamp_ = stamp;
  state_.predict(dt_s_, noise_scale_ * params_.acceleration.density());
}

std::optional<double> ObjectFilter::correct(const SE3& T_world_body, const Matrix6d& covariance) {
  Matrix12d& P = state_.covariance;
  const Vector6d innovation = (state_.T_world_body.inverse() * T_world_body).log();
  Eigen::LLT<Matrix6d> S(Matrix6d(P.topLeftCorner<6, 6>() + covariance));
  if (S.info() != Eigen::Success || !innovation.allFinite() || !covariance.allFinite()) return std::nullopt;
  const double normalized = innovation.dot(S.solve(innovation)) / 6;
  const double weight = robustWeight(RobustLoss::kHuber, std::sqrt(normalized), params_.innovation_scale);
  if (weight < 1) S.compute(Matrix6d(P.topLeftCorner<6, 6>() + covariance / weight));

  const Eigen::Matrix<double, 12, 6> PH = P.leftCols<6>();
  const Eigen::Matrix<double, 12, 6> K = S.solve(PH.transpose()).transpose();
  const Eigen::Matrix<double, 12, 1> correction = K * innovation;
  state_.T_world_body = (state_.T_world_body * SE3::exp(correction.head<6>())).normalized();
  state_.twist += correction.tail<6>();
  P -= K * PH.transpose();
  P = (0.5 * (P + P.transpose())).eval();
  if (params_.adapt_process_noise && dt_s_ > 0) adaptNoise(normalized);
  return normalized;
}

/// Adapts the process noise to the innovations, by a factor per time constant, within bounds: larger ones raise it.
void ObjectFilter::adaptNoise(double normalized_innovation) {
  constexpr double kMostPerStep = 10.0;   // a single wild innovation does not decide
  constexpr double kMostInTotal = 100.0;  // in variance: a tenth to ten times the accelerations that were set
  const double bounded = std::clamp(normalized_innovation, 1 / kMostPerStep, kMostPerStep);
  noise_scale_ =
      std::clamp(noise_scale_ * power(bounded, dt_s_ / params_.adaptation_time_s), 1 / kMostInTotal, kMostInTotal);
}

double ObjectFilter::speedSigma_mps() const {
  constexpr double kStanding_mps = 1e-9;  // slower, there is no direction: straight ahead is as good as any
  const Eigen::Vector3d velocity = state_.twist.head<3>();
  const double speed_mps = velocity.norm();
  const Eigen::Vector3d direction =
      speed_mps > kStanding_mps ? Eigen::Vector3d(velocity / speed_mps) : Eigen::Vector3d::UnitX();
  return std::sqrt(std::max(0.0, direction.dot(state_.velocityCovariance() * direction)));
}

}  // namespace motorcade
