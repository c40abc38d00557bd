#pragma once

#include "backend/graph/factor.hpp"

/// Measured motions between two poses, as public pose graphs state them:
///   e = [t(E); Log R(E)], E = Z^-1 Xi^-1 Xj, cost e^T Omega e
/// E's translation enters as it is, not through the logarithm of the whole motion. Omega must be positive semidefinite:
/// along a direction without information the factor says nothing.
namespace motorcade {

class RelativePoseFactorSE3 final : public JacobianFactor {
 public:
  RelativePoseFactorSE3(VariableId i, VariableId j, const SE3& Z_i_j, const Matrix6d& information);
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override;
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override;

 private:
  // Omega = S^T S with S = [A B; 0 C]. The rotation of Z is folded into A.
  Eigen::Matrix3d A_RzT_, B_, C_;
  Eigen::Matrix3d Rz_;
  Eigen::Vector3d tz_m_;
};

class RelativePoseFactorSE2 final : public JacobianFactor {
 public:
  RelativePoseFactorSE2(VariableId i, VariableId j, const SE2& Z_i_j, const Eigen::Matrix3d& information);
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override;
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override;

 private:
  Eigen::Matrix2d A_RzT_;
  Eigen::Vector2d b_;
  double c_;
  Eigen::Vector2d tz_m_;
  double angle_z_rad_;
};

/// Holds a pose in the plane at `mean`: e = [t(E); angle(E)], E = mean^-1 X. Its counterpart in space is PriorFactor.
class PriorFactorSE2 final : public JacobianFactor {
 public:
  PriorFactorSE2(VariableId variable, const SE2& mean, const Eigen::Matrix3d& information);
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override;
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override;

 private:
  SE2 mean_;
  Eigen::Matrix3d root_;
};

}  // namespace motorcade
