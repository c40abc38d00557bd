#include "backend/factors/twist_factors.hpp"

#include <cmath>

namespace motorcade {
namespace {

/// ad(xi) with [xi, eta] = ad(xi) eta.
Matrix6d ad(const Vector6d& xi) {
  Matrix6d result = Matrix6d::Zero();
  result.topLeftCorner<3, 3>() = result.bottomRightCorner<3, 3>() = hat(xi.tail<3>());
  result.topRightCorner<3, 3>() = hat(xi.head<3>());
  return result;
}

Vector6d twistOf(const Value& value) { return std::get<SmallVector>(value); }

std::vector<VariableId> variablesOf(const ConstantTwistFactor::Variables& v) {
  std::vector<VariableId> variables{v.c_a, v.w_a, v.c_b, v.w_b};
  if (v.x_a.valid()) variables.insert(variables.end(), {v.x_a, v.x_b});
  return variables;
}

}  // namespace

ConstantTwistFactor::ConstantTwistFactor(const Variables& v, const SE3& u, double dt_s,
                                         const Vector6d& acceleration_density, const Eigen::Matrix3d& R_body_travel)
    : JacobianFactor(variablesOf(v), 12), u_(u), dt_s_(dt_s), root_(Matrix6d::Zero()) {
  const Vector6d root = acceleration_density.cwiseSqrt().cwiseInverse();
  for (const int k : {0, 3}) root_.block<3, 3>(k, k) = root.segment<3>(k).asDiagonal() * R_body_travel.transpose();
}

SE3 ConstantTwistFactor::cameraMotion(std::span<const Value* const> values) const {
  if (values.size() == 4) return u_;
  return std::get<SE3>(*values[4]).inverse() * std::get<SE3>(*values[5]);
}

void ConstantTwistFactor::residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const {
  const SE3 motion = std::get<SE3>(*values[0]).inverse() * cameraMotion(values) * std::get<SE3>(*values[2]);
  const Vector6d xi = motion.log(), w_a = twistOf(*values[1]), w_b = twistOf(*values[3]);
  const Vector6d moved = xi - dt_s_ * w_a, changed = w_b + 0.5 * ad(xi) * w_b - w_a;
  // The Cholesky factor of the inverse of (dt^3/3, dt^2/2; dt^2/2, dt).
  r.head<6>() = root_ * (std::sqrt(12 / (dt_s_ * dt_s_ * dt_s_)) * moved - std::sqrt(3 / dt_s_) * changed);
  r.tail<6>() = root_ * changed / std::sqrt(dt_s_);
}

void ConstantTwistFactor::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  const SE3 &c_a = std::get<SE3>(*values[0]), &c_b = std::get<SE3>(*values[2]);
  const SE3 motion = c_a.inverse() * cameraMotion(values) * c_b;
  const Vector6d xi = motion.log(), w_b = twistOf(*values[3]);
  const Matrix6d J_b = rightJacobianInverseSE3(xi), J_a = -J_b * motion.inverse().adjoint();
  const int n = static_cast<int>(term.cols()) - 1;
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 36> moved(6, n), changed(6, n);
  moved.setZero();
  moved.middleCols<6>(0) = J_a;
  moved.middleCols<6>(12) = J_b;
  if (n == 36) {
    moved.middleCols<6>(24).noalias() = J_a * c_a.inverse().adjoint();
    moved.middleCols<6>(30).noalias() = J_b * c_b.inverse().adjoint();
  }
  changed.noalias() = -0.5 * ad(w_b) * moved;
  moved.middleCols<6>(6) = -dt_s_ * Matrix6d::Identity();
  changed.middleCols<6>(6) = -Matrix6d::Identity();
  changed.middleCols<6>(18) = Matrix6d::Identity() + 0.5 * ad(xi);
  term.topLeftCorner(6, n) = root_ * (std::sqrt(12 / (dt_s_ * dt_s_ * dt_s_)) * moved - std::sqrt(3 / dt_s_) * changed);
  term.bottomLeftCorner(6, n) = root_ * changed / std::sqrt(dt_s_);
  residual(values, term.col(n));
}

Eigen::Matrix3d travelAxes(const SmallVector& travel) { return expSO3({0, 0, travel[1]}) * expSO3({0, travel[2], 0}); }

RollingFactor::RollingFactor(VariableId w, VariableId travel, const RollingNoise& noise)
    : JacobianFactor({w, travel}, 2), noise_(noise) {}

void RollingFactor::residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const {
  const Vector6d w = twistOf(*values[0]);
  const auto& travel = std::get<SmallVector>(*values[1]);
  const Eigen::Matrix3d R = travelAxes(travel);
  r << R.col(1).dot(w.head<3>()) - travel[0] * R.col(2).dot(w.tail<3>()), R.col(2).dot(w.head<3>());
  r.array() /= Eigen::Array2d(noise_.sideways_mps, noise_.vertical_mps);
}

void RollingFactor::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  const Vector6d w = twistOf(*values[0]);
  const auto& travel = std::get<SmallVector>(*values[1]);
  const Eigen::Matrix3d R = travelAxes(travel);
  const Eigen::Vector3d side = R.col(1), up = R.col(2);
  const Eigen::Vector3d up_by_yaw = Eigen::Vector3d::UnitZ().cross(up), up_by_pitch = R.col(0);
  const Eigen::Vector3d v = w.head<3>(), turn = w.tail<3>();
  term.setZero();
  term.block<1, 3>(0, 0) = side.transpose();
  term.block<1, 3>(0, 3) = -travel[0] * up.transpose();
  term(0, 6) = -up.dot(turn);
  term(0, 7) = Eigen::Vector3d::UnitZ().cross(side).dot(v) - travel[0] * up_by_yaw.dot(turn);
  term(0, 8) = -travel[0] * up_by_pitch.dot(turn);
  term.block<1, 3>(1, 0) = up.transpose();
  term(1, 7) = up_by_yaw.dot(v);
  term(1, 8) = up_by_pitch.dot(v);
  term.row(0) /= noise_.sideways_mps;
  term.row(1) /= noise_.vertical_mps;
  residual(values, term.col(9));
}

VectorPriorFactor::VectorPriorFactor(VariableId v, const SmallVector& mean, const SmallVector& sigma)
    : JacobianFactor({v}, static_cast<int>(mean.size())), mean_(mean), inverse_sigma_(sigma.cwiseInverse()) {}

void VectorPriorFactor::residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const {
  r = inverse_sigma_.cwiseProduct(std::get<SmallVector>(*values[0]) - mean_);
}

void VectorPriorFactor::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  term.leftCols(mean_.size()) = inverse_sigma_.asDiagonal();
  residual(values, term.col(mean_.size()));
}

}  // namespace motorcade
