#pragma once

#include <array>
#include <optional>

#include "backend/factor.hpp"
#include "core/robust_loss.hpp"

namespace motorcade {

/// S with S^T S = covariance^-1; empty when the covariance is not positive definite.
std::optional<Matrix6d> squareRootInformation(const Matrix6d& covariance);

/// How much a factor's residual counts.
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
///   PoseResidual<N> Model::evaluate(const std::array<SE3, N>&) const
template <class Model, int N>
class PoseFactor final : public Factor {
 public:
  PoseFactor(const std::array<VariableId, N>& variables, const Model& model, const PoseNoise& noise)
      : Factor({variables.begin(), variables.end()}), model_(model), noise_(noise) {}

  const Model& model() const { return model_; }

  void linearize(std::span<const Value* const> values, LinearTerm& term) const override {
    std::array<SE3, N> poses;
    for (std::size_t k = 0; k < N; ++k) poses[k] = std::get<SE3>(*values[k]);
    const PoseResidual<N> raw = model_.evaluate(poses);
    Vector6d residual = noise_.sqrt_information * raw.residual;
    const double root_weight = std::sqrt(robustWeight(noise_.loss, residual.norm(), noise_.loss_scale));
    const Matrix6d whiten = root_weight * noise_.sqrt_information;
    term.form = LinearTerm::Form::kJacobian;
    term.matrix.resize(6, 6 * N + 1);
    for (std::size_t k = 0; k < N; ++k) term.matrix.template middleCols<6>(6 * static_cast<int>(k)).noalias() = whiten * raw.J[k];
    term.matrix.col(6 * N) = root_weight * residual;
  }

 private:
  Model model_;
  PoseNoise noise_;
};

}  // namespace motorcade
