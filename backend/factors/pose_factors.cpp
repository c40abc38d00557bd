#include "backend/factors/pose_factors.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "core/decompositions.hpp"

namespace motorcade {

std::optional<Matrix6d> squareRootInformation(const Matrix6d& covariance) {
  if (!covariance.allFinite()) return std::nullopt;
  const Eigen::LLT<Matrix6d> cholesky(Matrix6d(0.5 * (covariance + covariance.transpose())));
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  const Matrix6d root = cholesky.matrixL().solve(Matrix6d::Identity());
  if (!root.allFinite()) return std::nullopt;
  return root;
}

Vector6d PriorModel::residual(const std::array<SE3, 1>& T) const { return (mean.inverse() * T[0]).log(); }

PoseResidual<1> PriorModel::evaluate(const std::array<SE3, 1>& T) const {
  PoseResidual<1> result;
  result.residual = residual(T);
  result.J[0] = rightJacobianInverseSE3(result.residual);
  return result;
}

Vector6d poseSigmas(double sigma_m, double tilt_rad, double yaw_rad) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(sigma_m), tilt_rad, tilt_rad, yaw_rad;
  return sigma;
}

PoseNoise independentNoise(const Vector6d& sigma) { return {.sqrt_information = sigma.cwiseInverse().asDiagonal()}; }

std::unique_ptr<const JacobianFactor> priorFactor(VariableId v, const SE3& mean, const Vector6d& sigma) {
  return std::make_unique<PriorFactor>(std::array{v}, PriorModel{mean}, independentNoise(sigma));
}

Vector6d MotionModel::residual(const std::array<SE3, 2>& before_now) const {
  return (motion.inverse() * (before_now[0].inverse() * before_now[1])).log();
}

PoseResidual<2> MotionModel::evaluate(const std::array<SE3, 2>& before_now) const {
  const SE3 T_before_now = before_now[0].inverse() * before_now[1];
  PoseResidual<2> result;
  result.residual = (motion.inverse() * T_before_now).log();
  result.J[1] = rightJacobianInverseSE3(result.residual);
  result.J[0] = -result.J[1] * T_before_now.inverse().adjoint();
  return result;
}

Vector6d CameraEncounterModel::residual(const std::array<SE3, 3>& x_a_z) const {
  const auto& [x, a, z] = x_a_z;
  return ((a * z).inverse() * x * T_cam_body).inverse().log();
}

PoseResidual<3> CameraEncounterModel::evaluate(const std::array<SE3, 3>& x_a_z) const {
  const auto& [x, a, z] = x_a_z;
  const SE3 T_body_cam = (a * z).inverse() * x;
  PoseResidual<3> result;
  result.residual = (T_body_cam * T_cam_body).inverse().log();
  result.J[2] = rightJacobianInverseSE3(result.residual);
  result.J[1] = result.J[2] * z.inverse().adjoint();
  result.J[0] = -result.J[2] * T_body_cam.adjoint();
  return result;
}

Vector6d ObjectEncounterModel::residual(const std::array<SE3, 4>& am_zm_an_zn) const {
  const auto& [a_m, z_m, a_n, z_n] = am_zm_an_zn;
  return ((a_n * z_n).inverse() * (a_m * z_m) * T_m_n).inverse().log();
}

PoseResidual<4> ObjectEncounterModel::evaluate(const std::array<SE3, 4>& am_zm_an_zn) const {
  const auto& [a_m, z_m, a_n, z_n] = am_zm_an_zn;
  const SE3 T_n_m = (a_n * z_n).inverse() * (a_m * z_m);
  PoseResidual<4> result;
  result.residual = (T_n_m * T_m_n).inverse().log();
  result.J[3] = rightJacobianInverseSE3(result.residual);
  result.J[2] = result.J[3] * z_n.inverse().adjoint();
  result.J[1] = -result.J[3] * T_n_m.adjoint();
  result.J[0] = -result.J[3] * (T_n_m * z_m.inverse()).adjoint();
  return result;
}

Vector6d SmoothMotionModel::residual(const std::array<SE3, 3>& z) const {
  return (z[1].inverse() * z[2]).log() / dt_after_s - (z[0].inverse() * z[1]).log() / dt_before_s;
}

PoseResidual<3> SmoothMotionModel::evaluate(const std::array<SE3, 3>& z) const {
  const SE3 T_before = z[0].inverse() * z[1], T_after = z[1].inverse() * z[2];
  const Vector6d before = T_before.log(), after = T_after.log();
  const Matrix6d J_before = rightJacobianInverseSE3(before) / dt_before_s;
  const Matrix6d J_after = rightJacobianInverseSE3(after) / dt_after_s;
  PoseResidual<3> result;
  result.residual = after / dt_after_s - before / dt_before_s;
  result.J[0] = J_before * T_before.inverse().adjoint();
  result.J[1] = -J_after * T_after.inverse().adjoint() - J_before;
  result.J[2] = J_after;
  return result;
}

PoseNoise smoothMotionNoise(const AccelerationNoise& acceleration, double dt_before_s, double dt_after_s) {
  const Vector6d variance = 0.5 * (dt_before_s + dt_after_s) * acceleration.density();
  return {.sqrt_information = variance.cwiseSqrt().cwiseInverse().asDiagonal()};
}

}  // namespace motorcade
