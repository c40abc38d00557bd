#include "backend/joint/twist_factors.hpp"

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

/// Sideways velocity of the point `lever` behind the origin, and vertical velocity.
Eigen::Vector2d departure_mps(const Vector6d& w, double lever_m) { return {w[1] - lever_m * w[5], w[2]}; }

}  // namespace

ConstantTwistFactor::ConstantTwistFactor(const Variables& v, const SE3& u, double dt_s,
                                         const Vector6d& acceleration_density)
    : Factor(variablesOf(v), Form::kJacobian, 12),
      u_(u),
      dt_s_(dt_s),
      root_(acceleration_density.cwiseSqrt().cwiseInverse()) {}

SE3 ConstantTwistFactor::cameraMotion(std::span<const Value* const> values) const {
  if (values.size() == 4) return u_;
  return std::get<SE3>(*values[4]).inverse() * std::get<SE3>(*values[5]);
}

void ConstantTwistFactor::residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const {
  const SE3 motion = std::get<SE3>(*values[0]).inverse() * cameraMotion(values) * std::get<SE3>(*values[2]);
  const Vector6d xi = motion.log(), w_a = twistOf(*values[1]), w_b = twistOf(*values[3]);
  const Vector6d moved = xi - dt_s_ * w_a, changed = w_b + 0.5 * ad(xi) * w_b - w_a;
  // The Cholesky factor of the inverse of (dt^3/3, dt^2/2; dt^2/2, dt).
  r.head<6>() = root_.cwiseProduct(std::sqrt(12 / (dt_s_ * dt_s_ * dt_s_)) * moved - std::sqrt(3 / dt_s_) * changed);
  r.tail<6>() = root_.cwiseProduct(changed) / std::sqrt(dt_s_);
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
  term.topLeftCorner(6, n) =
      root_.asDiagonal() * (std::sqrt(12 / (dt_s_ * dt_s_ * dt_s_)) * moved - std::sqrt(3 / dt_s_) * changed);
  term.bottomLeftCorner(6, n) = root_.asDiagonal() * changed / std::sqrt(dt_s_);
  residual(values, term.col(n));
}

RollingFactor::RollingFactor(VariableId w, VariableId lever, const RollingNoise& noise)
    : Factor({w, lever}, Form::kJacobian, 2), noise_(noise) {}

void RollingFactor::residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const {
  const Eigen::Vector2d departure = departure_mps(twistOf(*values[0]), std::get<SmallVector>(*values[1])[0]);
  r << departure[0] / noise_.sideways_mps, departure[1] / noise_.vertical_mps;
}

void RollingFactor::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  const double lever_m = std::get<SmallVector>(*values[1])[0];
  term.setZero();
  term(0, 1) = 1 / noise_.sideways_mps;
  term(0, 5) = -lever_m / noise_.sideways_mps;
  term(0, 6) = -twistOf(*values[0])[5] / noise_.sideways_mps;
  term(1, 2) = 1 / noise_.vertical_mps;
  residual(values, term.col(7));
}

VectorPriorFactor::VectorPriorFactor(VariableId v, const SmallVector& mean, const SmallVector& sigma)
    : Factor({v}, Form::kJacobian, static_cast<int>(mean.size())), mean_(mean), inverse_sigma_(sigma.cwiseInverse()) {}

void VectorPriorFactor::residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const {
  r = inverse_sigma_.cwiseProduct(std::get<SmallVector>(*values[0]) - mean_);
}

void VectorPriorFactor::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  term.leftCols(mean_.size()) = inverse_sigma_.asDiagonal();
  residual(values, term.col(mean_.size()));
}

}  // namespace motorcade
