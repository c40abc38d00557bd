#include "backend/solver/null_space.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "backend/graph/sort_unique.hpp"
#include "backend/graph/symmetric_product.hpp"

namespace motorcade {
namespace {

/// Steps below this share of the largest are rounding. A turn of one radian that moves the ends of a graph by many
/// kilometers is not.
constexpr double kRoundingOfSteps = 1e-8;
/// A factor constrains a direction when its cost changes by more than this share of the change without cancellation.
/// Rounding leaves the square of 1e-8 of a Jacobian; an information matrix has been squared already.
constexpr double kRoundingOfJacobian = 1e-14, kRoundingOfInformation = 1e-10;

using Step = NullSpaceDirection::Step;
using Constraint = NullSpaceDirection::Constraint;

/// Back-substitution of a direction from its scalar's clique downwards.
class DirectionSubstitution {
 public:
  DirectionSubstitution(const FactorGraph& graph, const EliminationTree& tree) : graph_(graph), tree_(tree) {}

  std::vector<Step> from(const FrontalScalar& scalar) {
    const Clique& top = tree_[scalar.clique];
    const auto L = top.factor();
    Eigen::VectorXd x = Eigen::VectorXd::Unit(top.frontal_size, scalar.column);
    const Eigen::Index before = scalar.column;
    x.head(before) = -L.row(before).head(before).transpose();
    L.topLeftCorner(before, before).transpose().triangularView<Eigen::Upper>().solveInPlace(x.head(before));
    largest_ = x.cwiseAbs().maxCoeff();
    keep(top, x);
    std::vector<int> open{scalar.clique};
    while (!open.empty()) {
      const Clique& above = tree_[open.back()];
      open.pop_back();
      for (int child = above.first_child; child >= 0; child = tree_[child].next_sibling)
        if (descendInto(tree_[child])) open.push_back(child);
    }
    return steps_;
  }

 private:
  /// Descends into a clique; false when nothing moves there.
  bool descendInto(const Clique& clique) {
    Eigen::VectorXd separator = Eigen::VectorXd::Zero(clique.separatorSize());
    Eigen::Index at = 0;
    bool moves = false;
    for (const VariableId v : clique.separator()) {
      const auto found = step_of_.find(v);
      if (found != step_of_.end()) separator.segment(at, graph_.sizeOf(v)) = steps_[found->second].step;
      moves |= found != step_of_.end();
      at += graph_.sizeOf(v);
    }
    if (!moves) return false;
    const auto L = clique.factor();
    Eigen::VectorXd x = -(L.bottomRows(clique.separatorSize()).transpose() * separator);
    L.topRows(clique.frontal_size).transpose().triangularView<Eigen::Upper>().solveInPlace(x);
    largest_ = std::max(largest_, x.cwiseAbs().maxCoeff());
    keep(clique, x);
    return true;
  }

  void keep(const Clique& clique, const Eigen::VectorXd& x) {
    Eigen::Index at = 0;
    for (const VariableId v : clique.frontalVariables()) {
      SmallVector step = x.segment(at, graph_.sizeOf(v));
      at += graph_.sizeOf(v);
      step = (step.array().abs() > kRoundingOfSteps * largest_).select(step, 0.0).eval();
      if (step.isZero(0)) continue;
      step_of_.emplace(v, steps_.size());
      steps_.push_back({v, step});
    }
  }

  const FactorGraph& graph_;
  const EliminationTree& tree_;
  std::vector<Step> steps_;
  std::unordered_map<VariableId, std::size_t> step_of_;  // index in `steps_`
  double largest_ = 0;
};

/// Change of a factor's cost, and what it would be if nothing canceled.
struct CostChange {
  double cost = 0, without_cancellation = 0;
};

CostChange changeOf(const FactorGraph& graph, FactorId id, const std::unordered_map<VariableId, SmallVector>& steps) {
  Eigen::Index n = 0;
  for (const VariableId v : graph.variablesOf(id)) n += graph.sizeOf(v);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  Eigen::Index at = 0;
  for (const VariableId v : graph.variablesOf(id)) {
    if (const auto found = steps.find(v); found != steps.end()) x.segment(at, graph.sizeOf(v)) = found->second;
    at += graph.sizeOf(v);
  }
  const LinearModels& models = graph.models();
  if (models.isJacobian(id)) {
    const auto J = models.term(id).leftCols(n);
    return {(J * x).squaredNorm(), J.colwise().squaredNorm().dot(x.cwiseAbs2().transpose())};
  }
  const PackedTriangle H = models.information(id).H;
  Eigen::VectorXd Hx = Eigen::VectorXd::Zero(n);
  addSymmetricProduct(H, x.data(), Hx.data());
  CostChange change{.cost = x.dot(Hx)};
  for (int i = 0; i < H.size; ++i) change.without_cancellation += std::abs(H.column(i)[i]) * x[i] * x[i];
  return change;
}

Constraint constraintAlong(const FactorGraph& graph, const std::vector<Step>& moving) {
  std::unordered_map<VariableId, SmallVector> steps;
  std::vector<FactorId> factors;
  for (const auto& [v, step] : moving) {
    steps.emplace(v, step);
    factors.insert(factors.end(), graph.factorsOf(v).begin(), graph.factorsOf(v).end());
  }
  sortUnique(factors);
  bool constrained = false;
  CostChange sum;
  for (const FactorId f : factors) {
    const CostChange change = changeOf(graph, f, steps);
    const double rounding = graph.models().isJacobian(f) ? kRoundingOfJacobian : kRoundingOfInformation;
    constrained |= change.cost > rounding * change.without_cancellation;
    sum.cost += change.cost;
    sum.without_cancellation += change.without_cancellation;
  }
  if (sum.cost < -kRoundingOfInformation * sum.without_cancellation) return Constraint::kNegative;
  return constrained ? Constraint::kWeak : Constraint::kNone;
}

}  // namespace

std::vector<FrontalScalar> weakScalars(const EliminationTree& tree, int clique, double ratio) {
  std::vector<FrontalScalar> found;
  const auto L = tree[clique].factor();
  for (int column = 0; column < tree[clique].frontal_size; ++column) {
    const bool singular = std::ranges::find(tree[clique].singular, column) != tree[clique].singular.end();
    const double pivot = L(column, column) * L(column, column);
    const double diagonal = L.row(column).head(column + 1).squaredNorm();  // before elimination
    if (singular || pivot < ratio * diagonal) found.push_back({clique, column});
  }
  return found;
}

NullSpaceDirection nullSpaceDirection(const FactorGraph& graph, const EliminationTree& tree,
                                      const FrontalScalar& scalar) {
  NullSpaceDirection direction;
  int first = 0;
  for (const VariableId v : tree[scalar.clique].frontalVariables()) {
    if (first <= scalar.column) direction.held = v;
    first += graph.sizeOf(v);
  }
  direction.steps = DirectionSubstitution(graph, tree).from(scalar);
  direction.constraint = constraintAlong(graph, direction.steps);
  return direction;
}

}  // namespace motorcade
