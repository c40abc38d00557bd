#include "frontend/tracking/object_kinematics.hpp"

#include <cmath>

#include "core/fixed_product.hpp"
#include "frontend/geometry/cholesky.hpp"

namespace motorcade {
namespace {

/// S^-1 B for a positive definite S.
template <int N, int Columns>
Eigen::Matrix<double, N, Columns> solve(const Eigen::Matrix<double, N, N>& S,
                                        const Eigen::Matrix<double, N, Columns>& B) {
  const Cholesky<N> cholesky(S);
  Eigen::Matrix<double, N, Columns> solution;
  for (int c = 0; c < Columns; ++c) solution.col(c) = cholesky.solve(B.col(c));
  return solution;
}

/// Kalman update of the state by a linear measurement of its error, residual = J * error + noise of this `sigma`.
template <int N>
void correct(ConstantTwistState& state, const Eigen::Matrix<double, N, 1>& residual,
             const Eigen::Matrix<double, N, 12>& J, const Eigen::Matrix<double, N, 1>& sigma) {
  const Eigen::Matrix<double, N, 12> JP = fixedProduct(J, state.covariance);
  Eigen::Matrix<double, N, N> S = JP.lazyProduct(J.transpose());
  S.diagonal() += sigma.cwiseAbs2();
  const Eigen::Matrix<double, N, 12> K_transposed = solve<N, 12>(S, JP);
  const Eigen::Matrix<double, 12, N> K = K_transposed.transpose();
  const Eigen::Matrix<double, 12, 1> step = K * residual;
  state.T_world_body = (state.T_world_body * SE3::exp(step.template head<6>())).normalized();
  state.twist += step.template tail<6>();
  const Matrix12d I_KJ = Matrix12d::Identity() - fixedProduct(K, J);
  const Eigen::Matrix<double, 12, N> KR = K * sigma.cwiseAbs2().asDiagonal();
  // Joseph's form keeps the covariance symmetric and positive.
  state.covariance = congruence(I_KJ, state.covariance) + fixedProduct(KR, K_transposed);
}

}  // namespace

double ObjectKinematics::speedSigma_mps() const {
  constexpr double kNoDirection_mps = 1e-3;  // slower, the velocity has no direction: the mean over all of them
  const double speed = speed_mps();
  if (speed < kNoDirection_mps) return std::sqrt(velocityCovariance().trace() / 3);
  const Eigen::Vector3d direction = state_.twist.head<3>() / speed;
  return std::sqrt(direction.dot(velocityCovariance() * direction));
}

double ObjectKinematics::positionSigma_m() const { return std::sqrt(poseCovariance().topLeftCorner<3, 3>().trace()); }

void ObjectKinematics::acceptPose(const SE3& T_world_body, const Matrix6d& covariance) {
  Matrix12d& joint = state_.covariance;
  const Matrix6d P = poseCovariance(), cross = joint.bottomLeftCorner<6, 6>();
  const Matrix6d gain = solve<6, 6>(P, cross.transpose()).transpose();  // twist per pose
  state_.twist += gain * (state_.T_world_body.inverse() * T_world_body).log();
  state_.T_world_body = T_world_body;
  joint.topLeftCorner<6, 6>() = covariance;
  joint.bottomLeftCorner<6, 6>() = gain * covariance;
  joint.topRightCorner<6, 6>() = (gain * covariance).transpose();
  joint.bottomRightCorner<6, 6>() -= gain * (P - covariance) * gain.transpose();
}

void ObjectKinematics::fusePosition(const Eigen::Vector3d& p_body, const Eigen::Vector3d& p_world, double sigma_m) {
  Eigen::Matrix<double, 3, 12> J = Eigen::Matrix<double, 3, 12>::Zero();
  J.leftCols<3>() = Eigen::Matrix3d::Identity();
  J.middleCols<3>(3) = -hat(p_body);
  const Eigen::Vector3d residual = state_.T_world_body.inverse() * p_world - p_body;
  correct<3>(state_, residual, J, Eigen::Vector3d::Constant(sigma_m));
}

void ObjectKinematics::fuseVehicleModel(const Eigen::Vector3d& up_world, const Params& params) {
  Vector6d residual, sigma;
  Eigen::Matrix<double, 6, 12> J = Eigen::Matrix<double, 6, 12>::Zero();
  const Vector6d& twist = state_.twist;
  const Eigen::Vector3d up_body = state_.T_world_body.rotation().transpose() * up_world;
  residual << -twist[1], -twist[2], -twist[3], -twist[4], -up_body.x(), -up_body.y();
  sigma << params.slip_mps + params.slip_per_mps * std::abs(twist[0]), params.vertical_mps, params.tilt_rate_radps,
      params.tilt_rate_radps, params.tilt_rad, params.tilt_rad;
  for (int i = 0; i < 4; ++i) J(i, 7 + i) = 1;
  J.block<2, 3>(4, 3) = hat(up_body).topRows<2>();  // (R exp(phi))' up = up_body + up_body x phi
  correct<6>(state_, residual, J, sigma);
}

void ObjectKinematics::changeBodyFrame(const SE3& T_body_new) {
  const Matrix6d A = T_body_new.inverse().adjoint();
  state_.T_world_body = (state_.T_world_body * T_body_new).normalized();
  state_.twist = A * state_.twist;
  Matrix12d A2 = Matrix12d::Zero();
  A2.topLeftCorner<6, 6>() = A2.bottomRightCorner<6, 6>() = A;
  state_.covariance = congruence(A2, state_.covariance);
}

}  // namespace motorcade
