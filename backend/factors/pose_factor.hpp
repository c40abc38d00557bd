#pragma once

#include <array>
#include <optional>

#include "backend/graph/factor.hpp"
#include "core/robust_loss.hpp"

namespace motorcade {

/// S with S^T S = covariance^-1; empty when the covariance is not positive definite.
std::optional<Matrix6d> squareRootInformation(const Matrix6d& covariance);

/// Whitening and robust weighting of a factor's residual.
struct PoseNoise {
  Matrix6d sqrt_information = Matrix6d::Identity();
  RobustLoss loss = RobustLoss::kNone;
  double loss_scale = 1.0;
};

/// A residual of six dimensions over N poses, and its Jacobians under right perturbations, before whitening.
template <int N>
struct PoseResidual {
  Vector6d residual;
  std::array<Matrix6d, N> J;
};

/// Whitens and weights the residual that `Model` computes:
///   Vector6d Model::residual(const std::array<SE3, N>&) const
///   PoseResidual<N> Model::evaluate(const std::array<SE3, N>&) const
template <class Model, int N>
class PoseFactor final : public JacobianFactor {
 public:
  PoseFactor(const std::array<VariableId, N>& variables, const Model& model, const PoseNoise& noise)
      : JacobianFactor({variables.begin(), variables.end()}, 6), model_(model), noise_(noise) {}

  const Model& model() const { return model_; }

  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override {
    const PoseResidual<N> raw = model_.evaluate(posesOf(values));
    const Vector6d whitened = noise_.sqrt_information * raw.residual;
    const Matrix6d whiten = rootWeight(whitened) * noise_.sqrt_information;
    for (std::size_t k = 0; k < N; ++k) term.middleCols<6>(6 * static_cast<int>(k)).noalias() = whiten * raw.J[k];
    term.col(6 * N) = rootWeight(whitened) * whitened;
  }

  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override {
    const Vector6d whitened = noise_.sqrt_information * model_.residual(posesOf(values));
    r = rootWeight(whitened) * whitened;
  }

 private:
  static std::array<SE3, N> posesOf(std::span<const Value* const> values) {
    std::array<SE3, N> poses;
    for (std::size_t k = 0; k < N; ++k) poses[k] = std::get<SE3>(*values[k]);
    return poses;
  }
  double rootWeight(const Vector6d& whitened) const {
    return std::sqrt(robustWeight(noise_.loss, whitened.norm(), noise_.loss_scale));
  }

  Model model_;
  PoseNoise noise_;
};

}  // namespace motorcade
