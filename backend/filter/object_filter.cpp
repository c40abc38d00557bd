#include "backend/filter/object_filter.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace motorcade {

ObjectFilter::ObjectFilter(const Params& params, Timestamp stamp, const SE3& T_world_body, const Matrix6d& covariance)
    : params_(params), stamp_(stamp), T_world_body_(T_world_body) {
  P_.topLeftCorner<6, 6>() = covariance;
  P_.diagonal().segment<3>(6).setConstant(params.initial_speed_sigma_mps * params.initial_speed_sigma_mps);
  P_.diagonal().tail<3>().setConstant(params.initial_turn_rate_sigma_radps * params.initial_turn_rate_sigma_radps);
}

void ObjectFilter::predict(Timestamp stamp) {
  dt_s_ = secondsBetween(stamp_, stamp);
  if (!(dt_s_ > 0)) return;
  stamp_ = stamp;
  const SE3 step = SE3::exp(dt_s_ * twist_);
  T_world_body_ = (T_world_body_ * step).normalized();
  Matrix12d F = Matrix12d::Identity();
  F.topLeftCorner<6, 6>() = step.inverse().adjoint();
  F.topRightCorner<6, 6>() = dt_s_ * rightJacobianSE3(dt_s_ * twist_);
  // White noise of density q on the twist's derivative, integrated over the step.
  const Vector6d q = noise_scale_ * params_.acceleration.density();
  Matrix12d Q = Matrix12d::Zero();
  Q.topLeftCorner<6, 6>().diagonal() = q * (dt_s_ * dt_s_ * dt_s_ / 3);
  Q.topRightCorner<6, 6>().diagonal() = q * (dt_s_ * dt_s_ / 2);
  Q.bottomLeftCorner<6, 6>().diagonal() = q * (dt_s_ * dt_s_ / 2);
  Q.bottomRightCorner<6, 6>().diagonal() = q * dt_s_;
  P_ = F * P_ * F.transpose() + Q;
}

std::optional<double> ObjectFilter::correct(const SE3& T_world_body, const Matrix6d& covariance) {
  const Vector6d innovation = (T_world_body_.inverse() * T_world_body).log();
  Eigen::LLT<Matrix6d> S(P_.topLeftCorner<6, 6>() + covariance);
  if (S.info() != Eigen::Success || !innovation.allFinite() || !covariance.allFinite()) return std::nullopt;
  const double normalized = innovation.dot(S.solve(innovation)) / 6;
  const double weight = robustWeight(RobustLoss::kHuber, std::sqrt(normalized), params_.innovation_scale);
  if (weight < 1) S.compute(P_.topLeftCorner<6, 6>() + covariance / weight);

  const Eigen::Matrix<double, 12, 6> PH = P_.leftCols<6>();
  const Eigen::Matrix<double, 12, 6> K = S.solve(PH.transpose()).transpose();
  const Eigen::Matrix<double, 12, 1> correction = K * innovation;
  T_world_body_ = (T_world_body_ * SE3::exp(correction.head<6>())).normalized();
  twist_ += correction.tail<6>();
  P_ -= K * PH.transpose();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  if (params_.adapt_process_noise && dt_s_ > 0) {
    // Innovations larger than expected ask for more process noise; a factor per time constant, within bounds.
    const double bounded = std::clamp(normalized, 0.1, 10.0);
    noise_scale_ = std::clamp(noise_scale_ * std::pow(bounded, dt_s_ / params_.adaptation_time_s), 0.01, 100.0);
  }
  return normalized;
}

double ObjectFilter::speedSigma_mps() const {
  const Eigen::Vector3d velocity = twist_.head<3>();
  const double speed_mps = velocity.norm();
  const Eigen::Vector3d direction = speed_mps > 1e-9 ? Eigen::Vector3d(velocity / speed_mps) : Eigen::Vector3d::UnitX();
  return std::sqrt(std::max(0.0, direction.dot(P_.block<3, 3>(6, 6) * direction)));
}

}  // namespace motorcade
