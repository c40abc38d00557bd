#include "frontend/tracking/object_kinematics.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace motorcade {

double ObjectKinematics::speedSigma_mps() const {
  const double speed = speed_mps();
  if (speed < 1e-3) return std::sqrt(velocityCovariance().trace() / 3);
  const Eigen::Vector3d direction = twist_.head<3>() / speed;
  return std::sqrt(direction.dot(velocityCovariance() * direction));
}

void ObjectKinematics::predict(double dt_s, const Params& params) {
  const Vector6d step = dt_s * twist_;
  const SE3 motion = SE3::exp(step);
  Matrix12d F = Matrix12d::Identity();
  F.topLeftCorner<6, 6>() = motion.inverse().adjoint();
  F.topRightCorner<6, 6>() = dt_s * rightJacobianSE3(step);

  Vector6d density;  // of white noise on acceleration
  density << params.acceleration_along_mps2, params.acceleration_sideways_mps2, params.acceleration_vertical_mps2,
      params.acceleration_tilt_radps2, params.acceleration_tilt_radps2, params.acceleration_yaw_radps2;
  density = density.cwiseAbs2();
  Matrix12d Q = Matrix12d::Zero();
  const double span_s = std::abs(dt_s);
  Q.topLeftCorner<6, 6>().diagonal() = density * span_s * span_s * span_s / 3;
  Q.topRightCorner<6, 6>().diagonal() = density * dt_s * span_s / 2;
  Q.bottomLeftCorner<6, 6>() = Q.topRightCorner<6, 6>();
  Q.bottomRightCorner<6, 6>().diagonal() = density * span_s;

  T_world_body_ = (T_world_body_ * motion).normalized();
  covariance_ = F * covariance_ * F.transpose() + Q;
}

void ObjectKinematics::acceptPose(const SE3& T_world_body, const Matrix6d& covariance) {
  const Matrix6d P = poseCovariance(), cross = covariance_.bottomLeftCorner<6, 6>();
  const Matrix6d gain = P.ldlt().solve(cross.transpose()).transpose();  // twist per pose
  twist_ += gain * (T_world_body_.inverse() * T_world_body).log();
  T_world_body_ = T_world_body;
  covariance_.topLeftCorner<6, 6>() = covariance;
  covariance_.bottomLeftCorner<6, 6>() = gain * covariance;
  covariance_.topRightCorner<6, 6>() = (gain * covariance).transpose();
  covariance_.bottomRightCorner<6, 6>() -= gain * (P - covariance) * gain.transpose();
}

void ObjectKinematics::fusePlace(const Eigen::Vector3d& p_body, const Eigen::Vector3d& p_world, double sigma_m) {
  Eigen::Matrix<double, 3, 12> J = Eigen::Matrix<double, 3, 12>::Zero();
  J.leftCols<3>() = Eigen::Matrix3d::Identity();
  J.middleCols<3>(3) = -hat(p_body);
  correct<3>(T_world_body_.inverse() * p_world - p_body, J, Eigen::Vector3d::Constant(sigma_m));
}

void ObjectKinematics::fuseVehicleModel(const Eigen::Vector3d& up_world, const Params& params) {
  Eigen::Matrix<double, 6, 1> residual, sigma;
  Eigen::Matrix<double, 6, 12> J = Eigen::Matrix<double, 6, 12>::Zero();
  const Eigen::Vector3d up_body = T_world_body_.rotation().transpose() * up_world;
  residual << -twist_[1], -twist_[2], -twist_[3], -twist_[4], -up_body.x(), -up_body.y();
  sigma << params.slip_mps + params.slip_per_mps * std::abs(twist_[0]), params.vertical_mps, params.tilt_rate_radps,
      params.tilt_rate_radps, params.tilt_rad, params.tilt_rad;
  for (int i = 0; i < 4; ++i) J(i, 7 + i) = 1;
  J.block<2, 3>(4, 3) = hat(up_body).topRows<2>();  // (R exp(phi))' up = up_body + up_body x phi
  correct<6>(residual, J, sigma);
}

template <int N>
void ObjectKinematics::correct(const Eigen::Matrix<double, N, 1>& residual, const Eigen::Matrix<double, N, 12>& J,
                               const Eigen::Matrix<double, N, 1>& sigma) {
  Eigen::Matrix<double, N, N> S = J * covariance_ * J.transpose();
  S.diagonal() += sigma.cwiseAbs2();
  const Eigen::Matrix<double, 12, N> K = S.ldlt().solve(J * covariance_).transpose();
  const Eigen::Matrix<double, 12, 1> step = K * residual;
  T_world_body_ = (T_world_body_ * SE3::exp(step.template head<6>())).normalized();
  twist_ += step.template tail<6>();
  const Matrix12d I_KJ = Matrix12d::Identity() - K * J;  // Joseph's form keeps the covariance symmetric and positive
  covariance_ = I_KJ * covariance_ * I_KJ.transpose() + K * sigma.cwiseAbs2().asDiagonal() * K.transpose();
}

void ObjectKinematics::changeBodyFrame(const SE3& T_body_new) {
  const Matrix6d A = T_body_new.inverse().adjoint();
  T_world_body_ = (T_world_body_ * T_body_new).normalized();
  twist_ = A * twist_;
  Matrix12d A2 = Matrix12d::Zero();
  A2.topLeftCorner<6, 6>() = A2.bottomRightCorner<6, 6>() = A;
  covariance_ = A2 * covariance_ * A2.transpose();
}

}  // namespace motorcade
