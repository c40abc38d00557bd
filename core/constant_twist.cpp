#include "core/constant_twist.hpp"

#include <cmath>

#include "core/fixed_product.hpp"

namespace motorcade {

Matrix12d congruence(const Matrix12d& A, const Matrix12d& P) {
  const Matrix12d A_transposed = A.transpose();
  return fixedProduct(fixedProduct(A, P), A_transposed);
}

Vector6d AccelerationNoise::density() const {
  Vector6d sigma;
  sigma << along_mps2, sideways_mps2, vertical_mps2, tilt_radps2, tilt_radps2, yaw_radps2;
  return sigma.cwiseAbs2();
}

void ConstantTwistState::predict(double dt_s, const Vector6d& acceleration_density) {
  const Vector6d step = dt_s * twist;
  const SE3 motion = SE3::exp(step);
  Matrix12d F = Matrix12d::Identity();
  F.topLeftCorner<6, 6>() = motion.inverse().adjoint();
  F.topRightCorner<6, 6>() = dt_s * rightJacobianSE3(step);

  Matrix12d Q = Matrix12d::Zero();  // the noise integrated over the step
  const double span_s = std::abs(dt_s);
  Q.topLeftCorner<6, 6>().diagonal() = acceleration_density * span_s * span_s * span_s / 3;
  Q.topRightCorner<6, 6>().diagonal() = acceleration_density * dt_s * span_s / 2;
  Q.bottomLeftCorner<6, 6>() = Q.topRightCorner<6, 6>();
  Q.bottomRightCorner<6, 6>().diagonal() = acceleration_density * span_s;

  T_world_body = (T_world_body * motion).normalized();
  covariance = congruence(F, covariance) + Q;
}

}  // namespace motorcade
