#include "backend/graph/relative_pose_factor.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"

namespace motorcade {
namespace {

/// Upper triangular S with S^T S = information, which may leave directions open: a Cholesky decomposition breaks down
/// in them. Where a pivot is rounding alone, the row of S is zero.
template <int N>
Eigen::Matrix<double, N, N> semidefiniteUpperRoot(const Eigen::Matrix<double, N, N>& information) {
  constexpr double kRounding = 1e-12;  // of a diagonal entry
  Eigen::Matrix<double, N, N> left = information, root = Eigen::Matrix<double, N, N>::Zero();
  for (int k = 0; k < N; ++k) {
    if (!(left(k, k) > kRounding * information(k, k))) continue;
    for (int j = k; j < N; ++j) root(k, j) = left(k, j) / std::sqrt(left(k, k));
    for (int i = k + 1; i < N; ++i)
      for (int j = i; j < N; ++j) left(i, j) -= root(k, i) * root(k, j);
  }
  return root;
}

/// Upper triangular S with S^T S = information.
template <int N>
Eigen::Matrix<double, N, N> upperRoot(const Eigen::Matrix<double, N, N>& information) {
  constexpr double kLost = 1e-13;  // of a diagonal entry: what is left of it is rounding
  const Eigen::LLT<Eigen::Matrix<double, N, N>> cholesky(information);
  if (cholesky.info() != Eigen::Success) return semidefiniteUpperRoot<N>(information);
  Eigen::Matrix<double, N, N> root = cholesky.matrixU();
  if ((root.diagonal().array().square() < kLost * information.diagonal().array()).any())
    return semidefiniteUpperRoot<N>(information);
  return root;
}

/// Angle in [-pi, pi]; inlined, unlike std::remainder.
double wrapped(double angle_rad) {
  constexpr double kTurn_rad = 2 * std::numbers::pi;
  return angle_rad - kTurn_rad * std::nearbyint(angle_rad / kTurn_rad);
}

/// Log(R) and the factor k of its inverse right Jacobian:
/// Jr^-1 = I + [phi]_x / 2 + k [phi]_x^2, k = (1 - (t / 2) cot(t / 2)) / t^2.
struct RotationLog {
  Eigen::Vector3d phi_rad;
  double k;

  explicit RotationLog(const Eigen::Matrix3d& R) {
    Eigen::Quaterniond q(R);
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    const double n2 = q.vec().squaredNorm();
    if (n2 < 1e-8) {  // series in n = sin(t / 2), exact to double precision
      phi_rad = (2 + n2 / 3) * q.vec();
      k = 1.0 / 12 + n2 / 180;
      return;
    }
    const double n = std::sqrt(n2), half_rad = arcTangent(n, q.w());
    phi_rad = 2 * half_rad / n * q.vec();
    k = (1 - half_rad * q.w() / n) / (4 * half_rad * half_rad);
  }

  Eigen::Matrix3d rightJacobianInverse() const {
    // [phi]_x^2 = phi phi^T - t^2 I
    Eigen::Matrix3d J = k * phi_rad * phi_rad.transpose();
    J.diagonal().array() += 1 - k * phi_rad.squaredNorm();
    const Eigen::Vector3d h = 0.5 * phi_rad;
    J(0, 1) -= h.z(), J(1, 0) += h.z();
    J(2, 0) -= h.y(), J(0, 2) += h.y();
    J(1, 2) -= h.x(), J(2, 1) += h.x();
    return J;
  }
};

}  // namespace

RelativePoseFactorSE3::RelativePoseFactorSE3(VariableId i, VariableId j, const SE3& Z_i_j, const Matrix6d& information)
    : JacobianFactor({i, j}, 6), Rz_(Z_i_j.rotation()), tz_m_(Z_i_j.translation()) {
  const Matrix6d S = upperRoot<6>(information);
  A_RzT_ = S.topLeftCorner<3, 3>() * Rz_.transpose();
  B_ = S.topRightCorner<3, 3>();
  C_ = S.bottomRightCorner<3, 3>();
}

/// The translation part is A t(E) = A Rz^T (t_T - t_z), with T = Xi^-1 Xj. With Jr^-1 at Log R(E):
///   de/dxi_j = [R_E 0; 0 Jr^-1],  de/dxi_i = -de/dxi_j Ad(T^-1) = [-Rz^T  Rz^T [t_T]_x; 0  -Jr^-1 R_T^T]
void RelativePoseFactorSE3::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  const SE3 &Xi = std::get<SE3>(*values[0]), &Xj = std::get<SE3>(*values[1]);
  const Eigen::Matrix3d R = Xi.rotation().transpose() * Xj.rotation();
  const Eigen::Vector3d t_m = Xi.rotation().transpose() * (Xj.translation() - Xi.translation());
  const RotationLog log(Rz_.transpose() * R);
  const Eigen::Matrix3d Jr_inverse = log.rightJacobianInverse();
  const Eigen::Matrix3d B = B_ * Jr_inverse, C = C_ * Jr_inverse;
  const Eigen::Matrix3d B_RT = B * R.transpose(), C_RT = C * R.transpose();

  term.block<3, 3>(0, 0) = -A_RzT_;
  for (int row = 0; row < 3; ++row) {  // M [t]_x has the rows m x t
    const Eigen::Vector3d m = A_RzT_.row(row);
    term.block<1, 3>(row, 3) = m.cross(t_m).transpose() - B_RT.row(row);
  }
  term.block<3, 3>(3, 0).setZero();
  term.block<3, 3>(3, 3) = -C_RT;
  term.block<3, 3>(0, 6).noalias() = A_RzT_ * R;
  term.block<3, 3>(0, 9) = B;
  term.block<3, 3>(3, 6).setZero();
  term.block<3, 3>(3, 9) = C;
  term.block<3, 1>(0, 12).noalias() = A_RzT_ * (t_m - tz_m_) + B_ * log.phi_rad;
  term.block<3, 1>(3, 12).noalias() = C_ * log.phi_rad;
}

void RelativePoseFactorSE3::residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const {
  const SE3 &Xi = std::get<SE3>(*values[0]), &Xj = std::get<SE3>(*values[1]);
  const Eigen::Vector3d t_m = Xi.rotation().transpose() * (Xj.translation() - Xi.translation());
  const Eigen::Matrix3d Ri_Rz = Xi.rotation() * Rz_;
  const RotationLog log(Ri_Rz.transpose() * Xj.rotation());
  r.head<3>().noalias() = A_RzT_ * (t_m - tz_m_) + B_ * log.phi_rad;
  r.tail<3>().noalias() = C_ * log.phi_rad;
}

RelativePoseFactorSE2::RelativePoseFactorSE2(VariableId i, VariableId j, const SE2& Z_i_j,
                                             const Eigen::Matrix3d& information)
    : JacobianFactor({i, j}, 3), tz_m_(Z_i_j.translation()), angle_z_rad_(Z_i_j.angle_rad()) {
  const Eigen::Matrix3d S = upperRoot<3>(information);
  A_RzT_ = S.topLeftCorner<2, 2>() * Z_i_j.rotation().transpose();
  b_ = S.topRightCorner<2, 1>();
  c_ = S(2, 2);
}

/// The same as in space, with Jr^-1 = 1 and d(R^T t)/dangle in place of the cross product.
void RelativePoseFactorSE2::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  const SE2 &Xi = std::get<SE2>(*values[0]), &Xj = std::get<SE2>(*values[1]);
  const Eigen::Vector2d t_m = Xi.rotation().transpose() * (Xj.translation() - Xi.translation());
  const double turn_rad = Xj.angle_rad() - Xi.angle_rad(), angle_rad = wrapped(turn_rad - angle_z_rad_);
  const auto [sine, cosine] = sineCosine(turn_rad);

  term.block<2, 2>(0, 0) = -A_RzT_;
  term.block<2, 1>(0, 2) = A_RzT_ * Eigen::Vector2d(t_m.y(), -t_m.x()) - b_;
  term.block<1, 2>(2, 0).setZero();
  term(2, 2) = -c_;
  term.block<2, 1>(0, 3) = cosine * A_RzT_.col(0) + sine * A_RzT_.col(1);
  term.block<2, 1>(0, 4) = cosine * A_RzT_.col(1) - sine * A_RzT_.col(0);
  term.block<2, 1>(0, 5) = b_;
  term.block<1, 2>(2, 3).setZero();
  term(2, 5) = c_;
  term.block<2, 1>(0, 6) = A_RzT_ * (t_m - tz_m_) + angle_rad * b_;
  term(2, 6) = c_ * angle_rad;
}

void RelativePoseFactorSE2::residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const {
  const SE2 &Xi = std::get<SE2>(*values[0]), &Xj = std::get<SE2>(*values[1]);
  const Eigen::Vector2d t_m = Xi.rotation().transpose() * (Xj.translation() - Xi.translation());
  const double angle_rad = wrapped(Xj.angle_rad() - Xi.angle_rad() - angle_z_rad_);
  r.head<2>() = A_RzT_ * (t_m - tz_m_) + angle_rad * b_;
  r[2] = c_ * angle_rad;
}

PriorFactorSE2::PriorFactorSE2(VariableId variable, const SE2& mean, const Eigen::Matrix3d& information)
    : JacobianFactor({variable}, 3), mean_(mean), root_(upperRoot<3>(information)) {}

void PriorFactorSE2::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  const SE2 E = mean_.inverse() * std::get<SE2>(*values[0]);
  term.block<3, 2>(0, 0) = root_.leftCols<2>() * E.rotation();
  term.col(2) = root_.col(2);
  term.col(3) = root_ * Eigen::Vector3d(E.translation().x(), E.translation().y(), E.angle_rad());
}

void PriorFactorSE2::residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const {
  const SE2 E = mean_.inverse() * std::get<SE2>(*values[0]);
  r = root_ * Eigen::Vector3d(E.translation().x(), E.translation().y(), E.angle_rad());
}

}  // namespace motorcade
