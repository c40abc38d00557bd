#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "backend/graph/block_pool.hpp"
#include "backend/graph/factor.hpp"
#include "backend/graph/variable_states.hpp"

namespace motorcade {

/// The factors of a FactorGraph with a linear model of each, |J x + r|^2 in the coordinates x of its variables.
///
/// All factors of a variable take their Jacobians at the same linearization point. Otherwise they would disagree a
/// little on motions that no relative measurement sees (of the whole, as a rigid body), and seem to measure them. The
/// ends of long trajectories would then sway.
class LinearModels {
 public:
  /// [J | r] in the coordinates, column-major.
  using Term = Eigen::Map<Eigen::MatrixXd>;
  /// [H g; g^T c] in the coordinates.
  struct Information {
    PackedTriangle H;
    Eigen::Map<Eigen::VectorXd> g_c;
    auto g() const { return g_c.head(H.size); }
    double c() const { return g_c[H.size]; }
  };
  /// The error of a linear model at the estimates, in standard deviations.
  struct Mismatch {
    double norm = 0;
    std::span<const double> r;  // true residual minus the model's; of an InformationFactor, the gradient
  };

  explicit LinearModels(VariableStates& states) : states_(states) {}

  /// Adds a factor. Returns false, and adds nothing, when it is not finite at its variables' present values.
  bool add(FactorId id, AnyFactor factor);
  void remove(FactorId id);

  const Factor& factor(FactorId id) const { return slot(id).factor(); }
  /// Tells a JacobianFactor from an InformationFactor.
  bool isJacobian(FactorId id) const { return slot(id).jacobian != nullptr; }
  /// The factor as one of its kind; null when it is of the other.
  const JacobianFactor* jacobianFactor(FactorId id) const { return slot(id).jacobian.get(); }
  const InformationFactor* informationFactor(FactorId id) const { return slot(id).quadratic.get(); }
  /// Linear models of a JacobianFactor and of an InformationFactor.
  Term term(FactorId id) const;
  Information information(FactorId id) const;

  /// Makes a new linear model: the Jacobian at the linearization points, the residual at the estimates. Returns false,
  /// and keeps the former one, if the new one is not finite.
  bool linearize(FactorId id);
  /// Asks for what `mismatch` reads of a JacobianFactor and its model.
  void fetch(FactorId id) const;
  /// Mismatch of a factor's model at the estimates; its vector lasts until the next call.
  Mismatch mismatch(FactorId id);
  /// Shifts the model's residual (of an InformationFactor its gradient) by its mismatch; the Jacobian stays.
  void correctResidual(FactorId id, const Mismatch& mismatch);
  /// Sum of the corrected mismatches since the Jacobian was taken.
  double drift(FactorId id) const { return slot(id).drift; }

  /// True for a factor that is about to be replaced, so that the error of its linear model does not matter.
  bool isProvisional(FactorId id) const { return slot(id).provisional; }
  void markProvisional(FactorId id) { slots_[id.value].provisional = true; }

  /// Sum of the factors' squared residuals, each at the estimates when it was last looked at.
  double totalCost() const { return total_cost_; }
  /// Root mean square of the residuals' norms, in standard deviations: the scale of all tolerances. Only factors with
  /// residuals count, as the cost of a marginal prior contains everything that ever retired into it.
  double rmsResidual() const;
  std::size_t heldBytes() const { return terms_.heldBytes(); }

 private:
  struct Slot {
    std::unique_ptr<const JacobianFactor> jacobian;      // either this
    std::unique_ptr<const InformationFactor> quadratic;  // or that
    int columns = 0;
    double *term = nullptr, *g_c = nullptr;  // [J | r], or the lower triangle of H and [g; c]
    const double* lower_H = nullptr;         // `term`, or of the factor itself where that has the same
    double drift = 0, cost = 0;
    bool provisional = false;

    const Factor& factor() const { return jacobian ? static_cast<const Factor&>(*jacobian) : *quadratic; }
  };
  using AlignedVector = std::vector<double, Eigen::aligned_allocator<double>>;

  const Slot& slot(FactorId id) const { return slots_[id.value]; }
  std::span<const Value* const> valuesOf(const Factor& factor, Value VariableState::*member);
  Eigen::Map<Eigen::VectorXd> appliedCoordinates(const Factor& factor);
  bool linearizeResidual(Slot& slot);
  bool linearizeInformation(FactorId id);
  Mismatch informationMismatch(FactorId id);
  void setCost(Slot& slot, double cost);

  VariableStates& states_;
  std::vector<Slot> slots_;
  BlockPool terms_;
  double total_cost_ = 0, residual_cost_ = 0;
  std::int64_t residual_count_ = 0;
  // Scratch. Aligned: how Eigen sums up depends on where the memory lies, and results must not.
  std::vector<const Value*> values_;
  AlignedVector coordinates_, residual_, product_, matrix_;
  Quadratic quadratic_;
};

}  // namespace motorcade
