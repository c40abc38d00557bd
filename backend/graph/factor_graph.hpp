#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "backend/graph/block_pool.hpp"
#include "backend/graph/factor.hpp"

namespace motorcade {

/// The variables and factors of a least-squares problem, and a linear model of each factor.
///
/// Each variable has a coordinate vector x in which all linear models are stated, |J x + r|^2. Where the solver moves
/// x, the estimate follows by the same step in the world's axes: x adds up the steps of a variable since it was added.
/// No origin has to move when something is relinearized, so that it touches only the factors concerned, and a model
/// whose residual alone is off can be corrected by a new right-hand side.
///
/// All factors of a variable take their Jacobians at the same linearization point. Otherwise the motions that no
/// relative measurement sees (of the whole, as a rigid body) would be seen a little, differently by each factor, and
/// the ends of long trajectories would sway.
class FactorGraph {
 public:
  static constexpr int kMaxDimension = 6;
  using Coordinates = std::array<double, kMaxDimension>;

  struct Variable {
    int size = 0;
    bool alive = false;
    Coordinates x{};         // the solution of the linear system
    Coordinates x_spread{};  // the one that the cliques below were solved with
    Coordinates
        information{};  // diagonal of J^T J of its factors as they came: what a step means in standard deviations
    Coordinates x_compared{};    // where its factors' models were last compared with the factors
    Coordinates x_linearized{};  // at the linearization point
    Coordinates x_applied{};     // at the applied estimate
    Value applied_estimate;      // moves up to x before it is used
    Value linearization_point;   // where the Jacobians of all its factors are taken
    std::vector<FactorId> factors;
  };
  /// [J | r] in the coordinates, column-major.
  using Term = Eigen::Map<Eigen::MatrixXd>;
  /// [H g; g^T c] in the coordinates.
  struct Information {
    PackedTriangle H;
    Eigen::Map<Eigen::VectorXd> g_c;
    auto g() const { return g_c.head(H.size); }
    double c() const { return g_c[H.size]; }
  };

  VariableId addVariable(const Value& initial);
  /// The variable must have no factors any more.
  void removeVariable(VariableId id);

  /// Empty, and nothing is added, when the factor is not finite at its variables' present values.
  std::optional<FactorId> addFactor(AnyFactor factor);
  void removeFactor(FactorId id);

  /// Lets the estimate follow x.
  void apply(VariableId id);
  /// A bound, in standard deviations, of how far the linear models of the variable's factors went off by its steps
  /// since they were last compared: mismatch comes from turning and grows with turn times step. For vectors, whose
  /// factors are bilinear at most, a guess: a fixed share of the step.
  double mismatchBound(VariableId id) const;
  bool isVector(VariableId id) const { return std::holds_alternative<SmallVector>((*this)[id].applied_estimate); }
  void markCompared(VariableId id) { (*this)[id].x_compared = (*this)[id].x; }
  /// Applies all x, and begins them at zero again: all models must be linearized anew.
  void restartCoordinates();
  /// The Jacobians of the variable's factors are to be taken where its estimate stands: linearize them after that.
  void moveLinearizationPoint(VariableId id);
  /// How far the estimate has turned since [rad].
  double turnSinceLinearization(VariableId id) const;
  /// A new linear model: the Jacobian at the linearization points, the residual at the estimates. Keeps the former one
  /// if the new one is not finite.
  void linearize(FactorId id);
  /// How far the linear model is off at the estimates, in standard deviations. The vector lasts until the next call.
  struct Mismatch {
    double norm = 0;
    std::span<const double> r;  // true residual minus the model's; of an InformationFactor, the gradient
  };
  Mismatch mismatch(FactorId id);
  /// Shifts the model's residual (of an InformationFactor its gradient) by a mismatch; the Jacobian stays.
  void correctResidual(FactorId id, std::span<const double> r);

  const Variable& operator[](VariableId id) const { return variables_[id.value]; }
  Variable& operator[](VariableId id) { return variables_[id.value]; }
  const Factor& factor(FactorId id) const { return slot(id).factor(); }
  /// Tells a JacobianFactor from an InformationFactor.
  bool isJacobian(FactorId id) const { return slot(id).jacobian != nullptr; }
  /// The factor as one of its kind; null when it is of the other.
  const JacobianFactor* jacobianFactor(FactorId id) const { return slot(id).jacobian.get(); }
  const InformationFactor* informationFactor(FactorId id) const { return slot(id).quadratic.get(); }
  std::span<const VariableId> variablesOf(FactorId id) const { return variables_of_[id.value]; }
  /// The linear model of a JacobianFactor, and of an InformationFactor.
  Term term(FactorId id) const;
  Information information(FactorId id) const;

  /// About to be replaced: nobody asks how far its linear model is off.
  bool isProvisional(FactorId id) const { return slot(id).provisional; }
  void markProvisional(FactorId id) { factors_[id.value].provisional = true; }

  /// Sum of the mismatches since the Jacobian was taken.
  double drift(FactorId id) const { return slot(id).drift; }
  void addDrift(FactorId id, double mismatch) { factors_[id.value].drift += mismatch; }
  /// Sum of the factors' squared residuals, each at the estimates when it was last looked at.
  double totalCost() const { return total_cost_; }
  /// Root mean square of the residuals' norms, in standard deviations, over the factors with residuals: the cost of a
  /// marginal prior counts everything that ever retired into it. It is the scale of all tolerances.
  double rmsResidual() const;

  int sizeOf(VariableId id) const { return (*this)[id].size; }
  Value estimate(VariableId id) const;

  std::size_t slots() const { return variables_.size(); }  // ids are below it
  std::size_t factorSlots() const { return factors_.size(); }
  std::size_t variableCount() const { return variables_.size() - free_variables_.size(); }
  std::size_t factorCount() const { return factors_.size() - free_factors_.size(); }
  bool contains(FactorId id) const;
  bool contains(VariableId id) const;
  /// In ascending order of ids.
  std::vector<VariableId> variables() const;
  std::vector<FactorId> factors() const;
  std::size_t termBytes() const { return terms_.heldBytes(); }

 private:
  struct LinearizedFactor {
    std::unique_ptr<const JacobianFactor> jacobian;      // either this
    std::unique_ptr<const InformationFactor> quadratic;  // or that
    int columns = 0;
    double *term = nullptr, *g_c = nullptr;  // [J | r], or the lower triangle of H and [g; c]
    const double* lower_H = nullptr;         // `term`, or of the factor itself where that has the same
    double drift = 0, cost = 0;
    bool provisional = false;

    bool used() const { return jacobian || quadratic; }
    const Factor& factor() const { return jacobian ? static_cast<const Factor&>(*jacobian) : *quadratic; }
  };
  const LinearizedFactor& slot(FactorId id) const { return factors_[id.value]; }
  void apply(const Factor& factor);
  static double turnBetween(const Variable& variable, const Coordinates& from, const Coordinates& to);
  std::span<const Value* const> valuesOf(const Factor& factor, Value Variable::*member);
  Eigen::Map<Eigen::VectorXd> appliedCoordinates(const Factor& factor);
  void turnToWorldAxes(const Factor& factor, Term& term) const;
  static Information informationOf(const LinearizedFactor& slot);
  bool linearize(LinearizedFactor& slot);
  bool linearizeResidual(LinearizedFactor& slot);
  bool linearizeInformation(LinearizedFactor& slot);
  void giveBack(LinearizedFactor& slot);
  Mismatch informationMismatch(FactorId id);
  void setCost(LinearizedFactor& slot, double cost);

  std::vector<Variable> variables_;
  std::vector<LinearizedFactor> factors_;
  std::vector<std::span<const VariableId>>
      variables_of_;  // per factor; close to each other: searches pass many factors
  std::vector<VariableId> free_variables_;
  std::vector<FactorId> free_factors_;
  BlockPool terms_;
  double total_cost_ = 0, residual_cost_ = 0;
  std::int64_t residual_count_ = 0;
  std::vector<const Value*> values_;  // scratch
  // Aligned: how Eigen sums up depends on where the memory lies, and results must not.
  std::vector<double, Eigen::aligned_allocator<double>> coordinates_, residual_, product_,
      matrix_;           // scratch
  Quadratic quadratic_;  // scratch
};

}  // namespace motorcade
