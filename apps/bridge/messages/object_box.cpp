#include "apps/bridge/messages/object_box.hpp"

#include "apps/bridge/messages/matrix_rows.hpp"

namespace motorcade {

SE3 boxInBody(const Result::Object& object) {
  return {Eigen::Matrix3d::Identity(), vectorFrom(object.box_center_body_m)};
}

std::optional<Matrix6d> boxCovariance(const Result::Object& object) {
  if (!object.covariance) return std::nullopt;
  const Matrix6d adjoint = boxInBody(object).inverse().adjoint();
  Matrix6d covariance = adjoint * matrixOf<6>(*object.covariance) * adjoint.transpose();
  covariance.diagonal().head<3>() += vectorFrom(object.box_center_sigma_m).cwiseAbs2();
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

}  // namespace motorcade
