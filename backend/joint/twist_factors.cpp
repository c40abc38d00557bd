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

/// Sideways velocity of the point `lever` behind the origin, and vertical velocity.
Eigen::Vector2d departure_mps(const Vector6d& w, double lever_m) { return {w[1] - lever_m * w[5], w[2]}; }

}  // namespace

ConstantTwistFactor::ConstantTwistFactor(const Variables& v, double dt_s, const Vector6d& acceleration_density)
    : Factor({v.T_a, v.w_a, v.T_b, v.w_b}, Form::kJacobian, 12),
      dt_s_(dt_s),
      root_(acceleration_density.cwiseSqrt().cwiseInverse()) {}

void ConstantTwistFactor::residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const {
  const Vector6d xi = (std::get<SE3>(*values[0]).inverse() * std::get<SE3>(*values[2])).log();
  const Vector6d w_a = twistOf(*values[1]), w_b = twistOf(*values[3]);
  const Vector6d moved = xi - dt_s_ * w_a, changed = w_b + 0.5 * ad(xi) * w_b - w_a;
  // The Cholesky factor of the inverse of (dt^3/3, dt^2/2; dt^2/2, dt).
  r.head<6>() =
      root_.cwiseProduct(std::sqrt(12 / (dt_s_ * dt_s_ * dt_s_)) * moved - std::sqrt(3 / dt_s_) * changed);
  r.tail<6>() = root_.cwiseProduct(changed) / std::sqrt(dt_s_);
}

void ConstantTwistFactor::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  const SE3 T_a_b = std::get<SE3>(*values[0]).inverse() * std::get<SE3>(*values[2]);
  const Vector6d xi = T_a_b.log(), w_b = twistOf(*values[3]);
  using Matrix6x24d = Eigen::Matrix<double, 6, 24>;
  Matrix6x24d moved, changed;
  const Matrix6d J_b = rightJacobianInverseSE3(xi), J_a = -J_b * T_a_b.inverse().adjoint();
  const Matrix6d turned = -0.5 * ad(w_b);
  moved << J_a, -dt_s_ * Matrix6d::Identity(), J_b, Matrix6d::Zero();
  changed << turned * J_a, -Matrix6d::Identity(), turned * J_b, Matrix6d::Identity() + 0.5 * ad(xi);
  term.topLeftCorner<6, 24>() =
      root_.asDiagonal() * (std::sqrt(12 / (dt_s_ * dt_s_ * dt_s_)) * moved - std::sqrt(3 / dt_s_) * changed);
  term.bottomLeftCorner<6, 24>() = root_.asDiagonal() * changed / std::sqrt(dt_s_);
  residual(values, term.col(24));
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
