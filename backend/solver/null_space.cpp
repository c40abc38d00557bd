#include "backend/solver/null_space.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <Eigen/Dense>

namespace motorcade {
namespace {

/// Steps below that, over the largest, are rounding. A turn of one radian that moves the ends of a graph by many
/// kilometers is not.
constexpr double kRoundingOfSteps = 1e-8;
/// A factor sees a motion when its cost changes by more than that, over what it would change by without cancellation.
/// Rounding leaves the square of 1e-8 of a Jacobian; an information matrix has been squared already.
constexpr double kUnseenJacobian = 1e-14, kUnseenInformation = 1e-10;

using Steps = std::unordered_map<VariableId, SmallVector>;

/// The rows of R that belong to a clique, transposed.
Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> panelOf(const Clique& clique) {
  return {clique.panel, clique.size, clique.frontal_size, Eigen::OuterStride<>(clique.panelStride())};
}

/// Back-substitution of a motion from its scalar's clique downwards.
class Descent {
 public:
  Descent(const FactorGraph& graph, const EliminationTree& tree) : graph_(graph), tree_(tree) {}

  std::vector<NullMotion::Step> from(const FrontalScalar& scalar) {
    const Clique& top = tree_[scalar.clique];
    const auto L = panelOf(top);
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
  /// False when nothing moves there.
  bool descendInto(const Clique& clique) {
    Eigen::VectorXd separator = Eigen::VectorXd::Zero(clique.separatorSize());
    Eigen::Index at = 0;
    bool moves = false;
    for (const VariableId v : clique.separator()) {
      const auto found = place_.find(v);
      if (found != place_.end()) separator.segment(at, graph_.sizeOf(v)) = steps_[found->second].step;
      moves |= found != place_.end();
      at += graph_.sizeOf(v);
    }
    if (!moves) return false;
    const auto L = panelOf(clique);
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
      place_.emplace(v, steps_.size());
      steps_.push_back({v, step});
    }
  }

  const FactorGraph& graph_;
  const EliminationTree& tree_;
  std::vector<NullMotion::Step> steps_;
  std::unordered_map<VariableId, std::size_t> place_;  // in `steps_`
  double largest_ = 0;
};

/// By how much a factor's cost changes, and by how much it would if nothing canceled.
struct Change {
  double cost = 0, without_cancellation = 0;
};

Change changeOf(const FactorGraph& graph, FactorId id, const Steps& steps) {
  const Factor& factor = graph.factor(id);
  const auto term = graph.term(id);
  const Eigen::Index n = term.cols() - 1;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  Eigen::Index at = 0;
  for (const VariableId v : factor.variables()) {
    if (const auto found = steps.find(v); found != steps.end()) x.segment(at, graph.sizeOf(v)) = found->second;
    at += graph.sizeOf(v);
  }
  if (factor.form() == Factor::Form::kJacobian)
    return {(term.leftCols(n) * x).squaredNorm(),
            term.leftCols(n).colwise().squaredNorm().dot(x.cwiseAbs2().transpose())};
  const auto H = term.topLeftCorner(n, n);
  return {x.dot(H.selfadjointView<Eigen::Lower>() * x), H.diagonal().cwiseAbs().dot(x.cwiseAbs2())};
}

NullMotion::Seen seenBy(const FactorGraph& graph, const std::vector<NullMotion::Step>& moving) {
  Steps steps;
  std::vector<FactorId> factors;
  for (const auto& [v, step] : moving) {
    steps.emplace(v, step);
    factors.insert(factors.end(), graph[v].factors.begin(), graph[v].factors.end());
  }
  std::ranges::sort(factors);
  factors.erase(std::unique(factors.begin(), factors.end()), factors.end());
  bool seen = false;
  Change sum;
  for (const FactorId f : factors) {
    const Change change = changeOf(graph, f, steps);
    const double unseen = graph.factor(f).form() == Factor::Form::kJacobian ? kUnseenJacobian : kUnseenInformation;
    seen |= change.cost > unseen * change.without_cancellation;
    sum.cost += change.cost;
    sum.without_cancellation += change.without_cancellation;
  }
  if (sum.cost < -kUnseenInformation * sum.without_cancellation) return NullMotion::Seen::kNegative;
  return seen ? NullMotion::Seen::kByFew : NullMotion::Seen::kByNone;
}

}  // namespace

void appendWeakScalars(const EliminationTree& tree, int clique, double ratio, std::vector<FrontalScalar>& found) {
  const auto L = panelOf(tree[clique]);
  for (int column = 0; column < tree[clique].frontal_size; ++column) {
    const bool singular = std::ranges::find(tree[clique].singular, column) != tree[clique].singular.end();
    const double pivot = L(column, column) * L(column, column);
    const double diagonal = L.row(column).head(column + 1).squaredNorm();  // before elimination
    if (singular || pivot < ratio * diagonal) found.push_back({clique, column});
  }
}

NullMotion nullMotion(const FactorGraph& graph, const EliminationTree& tree, const FrontalScalar& scalar) {
  NullMotion motion;
  int first = 0;
  for (const VariableId v : tree[scalar.clique].frontalVariables()) {
    if (first <= scalar.column) motion.held = v;
    first += graph.sizeOf(v);
  }
  motion.steps = Descent(graph, tree).from(scalar);
  motion.seen = seenBy(graph, motion.steps);
  return motion;
}

}  // namespace motorcade
