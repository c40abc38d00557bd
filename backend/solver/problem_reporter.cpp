#include "backend/solver/problem_reporter.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "backend/solver/null_space.hpp"

namespace motorcade {
namespace {

using Kind = SolverProblem::Kind;

int rootOf(const EliminationTree& tree, int clique) {
  while (tree[clique].parent >= 0) clique = tree[clique].parent;
  return clique;
}

bool concernsPart(Kind kind) { return kind == Kind::kMissingPrior || kind == Kind::kDisconnectedPart; }

/// A connected part of the graph has one root.
std::int64_t variablesBelow(const EliminationTree& tree, int root) {
  std::int64_t count = 0;
  std::vector<int> open{root};
  while (!open.empty()) {
    const Clique& clique = tree[open.back()];
    open.pop_back();
    count += clique.frontals;
    for (int child = clique.first_child; child >= 0; child = tree[child].next_sibling) open.push_back(child);
  }
  return count;
}

/// A basis of what the columns span with as many zeros as it can have, each of unit length.
std::vector<SmallVector> sparseBasis(Eigen::MatrixXd columns) {
  constexpr double kRounding = 1e-7;
  const double largest = columns.cwiseAbs().maxCoeff();
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pivots;  // row, column
  Eigen::MatrixXd rest = columns;
  while (pivots.size() < static_cast<std::size_t>(columns.cols())) {
    Eigen::Index row = 0, column = 0;
    if (rest.cwiseAbs().maxCoeff(&row, &column) <= kRounding * largest) break;
    columns.col(column) /= columns(row, column);
    for (Eigen::Index other = 0; other < columns.cols(); ++other)
      if (other != column) columns.col(other) -= columns(row, other) * columns.col(column);
    pivots.emplace_back(row, column);
    rest = columns;
    for (const auto& [r, c] : pivots) rest.col(c).setZero();
  }
  std::ranges::sort(pivots);
  std::vector<SmallVector> basis;
  for (const auto& [row, column] : pivots) {
    SmallVector direction = columns.col(column);
    direction = (direction.array().abs() > kRounding * direction.cwiseAbs().maxCoeff()).select(direction, 0.0).eval();
    basis.push_back(direction.normalized());
  }
  return basis;
}

/// From a step in the world's axes to the variable's own perturbation, where its Jacobians were taken.
SmallVector toOwnAxes(const FactorGraph& graph, VariableId v, SmallVector step) {
  const Value& value = graph[v].linearization_point;
  if (const auto* pose = std::get_if<SE3>(&value)) {
    step.head<3>() = (pose->rotation().transpose() * step.head<3>()).eval();
    step.tail<3>() = (pose->rotation().transpose() * step.tail<3>()).eval();
  } else if (const auto* planar = std::get_if<SE2>(&value)) {
    step.head<2>() = (planar->rotation().transpose() * step.head<2>()).eval();
  }
  return step;
}

using Motions = std::vector<const NullMotion*>;

/// The one who is held in most motions, and of these the one whose motion comes last.
VariableId mostHeld(const Motions& motions) {
  const auto times = [&](VariableId v) { return std::ranges::count(motions, v, &NullMotion::held); };
  VariableId most = motions.front()->held;
  for (const NullMotion* motion : motions)
    if (times(motion->held) >= times(most)) most = motion->held;
  return most;
}

/// One problem of motions that belong together.
SolverProblem merged(const FactorGraph& graph, Kind kind, const Motions& motions, std::int64_t part_variables) {
  const VariableId v = mostHeld(motions);
  SolverProblem problem{.kind = kind, .variable = v, .factors = graph[v].factors};
  problem.part_variables = part_variables;
  problem.freedoms = static_cast<std::int64_t>(motions.size());
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(graph.sizeOf(v), static_cast<Eigen::Index>(motions.size()));
  std::vector<VariableId> moving;
  Eigen::Index column = 0;
  for (const NullMotion* motion : motions) {
    for (const auto& [u, step] : motion->steps) {
      moving.push_back(u);
      if (u == v) own.col(column) = toOwnAxes(graph, v, step);
    }
    ++column;
  }
  problem.directions = sparseBasis(own);
  std::ranges::sort(moving);
  problem.moving_variables = std::unique(moving.begin(), moving.end()) - moving.begin();
  return problem;
}

/// What is wrong with one connected part.
class PartProblems {
 public:
  PartProblems(const FactorGraph& graph, std::int64_t part_variables)
      : graph_(graph), part_variables_(part_variables) {}

  void add(NullMotion&& motion) { motions_.push_back(std::move(motion)); }

  std::vector<SolverProblem> problems() const {
    const bool whole_part_moves = std::ranges::any_of(motions_, [&](const NullMotion& m) { return movesPart(m); });
    Motions of_part;
    std::map<std::pair<VariableId, Kind>, Motions> of_variables;
    for (const NullMotion& motion : motions_) {
      if (whole_part_moves && isJoint(motion))
        of_part.push_back(&motion);
      else
        of_variables[{motion.held, kindOf(motion)}].push_back(&motion);
    }
    std::vector<SolverProblem> problems;
    if (!of_part.empty()) problems.push_back(merged(graph_, Kind::kMissingPrior, of_part, part_variables_));
    for (const auto& [key, motions] : of_variables)
      problems.push_back(merged(graph_, key.second, motions, part_variables_));
    return problems;
  }

 private:
  static Kind kindOf(const NullMotion& motion) {
    if (motion.seen == NullMotion::Seen::kNegative) return Kind::kIndefinite;
    return motion.seen == NullMotion::Seen::kByFew ? Kind::kBadlyConditioned : Kind::kUnconstrained;
  }
  /// By motions that nothing sees, of more than a variable that has factors of its own.
  bool isJoint(const NullMotion& motion) const {
    return motion.seen == NullMotion::Seen::kByNone && (motion.steps.size() > 1 || graph_[motion.held].factors.empty());
  }
  bool movesPart(const NullMotion& motion) const {
    return isJoint(motion) && static_cast<std::int64_t>(motion.steps.size()) == part_variables_;
  }

  const FactorGraph& graph_;
  std::int64_t part_variables_;
  std::vector<NullMotion> motions_;
};

/// All that is wrong now.
std::vector<SolverProblem> findProblems(const FactorGraph& graph, const EliminationTree& tree) {
  std::map<int, std::vector<FrontalScalar>> weak;  // per root
  std::vector<FrontalScalar> found;
  for (int clique = 0; clique < static_cast<int>(tree.slots()); ++clique) {
    if (!tree[clique].alive) continue;
    found.clear();
    appendWeakScalars(tree, clique, SolverExplanations::kWeakPivot, found);
    if (found.empty()) continue;
    auto& of_part = weak[rootOf(tree, clique)];
    of_part.insert(of_part.end(), found.begin(), found.end());
  }
  std::vector<SolverProblem> problems;
  std::size_t free_parts = 0;
  for (const auto& [root, scalars] : weak) {
    PartProblems part(graph, variablesBelow(tree, root));
    for (const FrontalScalar& scalar : scalars) part.add(nullMotion(graph, tree, scalar));
    const auto of_part = part.problems();
    if (std::ranges::any_of(of_part, concernsPart, &SolverProblem::kind)) ++free_parts;
    problems.insert(problems.end(), of_part.begin(), of_part.end());
  }
  if (free_parts < tree.roots().size())
    for (SolverProblem& problem : problems)
      if (problem.kind == Kind::kMissingPrior) problem.kind = Kind::kDisconnectedPart;
  std::ranges::sort(problems, {}, &SolverProblem::variable);
  return problems;
}

}  // namespace

void SolverExplanations::append(const FactorGraph& graph, const EliminationTree& tree,
                                std::vector<SolverProblem>& problems) {
  if (tree.singular().empty() && tree.weakestPivot().ratio >= kWeakPivot) {
    if (!told_.empty()) forgetMended(graph, tree);
    return;
  }
  std::vector<Told> still;
  for (SolverProblem& problem : findProblems(graph, tree)) {
    const std::int64_t told = toldFreedoms(problem, tree);
    still.push_back({problem.kind, problem.variable, std::max(told, problem.freedoms)});
    if (told < problem.freedoms) problems.push_back(std::move(problem));
  }
  told_ = std::move(still);
}

/// Of the problem as it was told, 0 if it was not.
std::int64_t SolverExplanations::toldFreedoms(const SolverProblem& problem, const EliminationTree& tree) const {
  std::int64_t most = 0;
  for (const Told& told : told_) {
    if (told.kind != problem.kind) continue;
    // Of a part that moves as a whole it may now be another variable that is held.
    const int clique = tree.cliqueOf(told.variable);
    const bool same_part = concernsPart(problem.kind) && clique >= 0 &&
                           rootOf(tree, clique) == rootOf(tree, tree.cliqueOf(problem.variable));
    if (told.variable == problem.variable || same_part) most = std::max(most, told.freedoms);
  }
  return most;
}

/// Nothing weak was eliminated in this update: those problems are gone whose variables were.
void SolverExplanations::forgetMended(const FactorGraph& graph, const EliminationTree& tree) {
  std::vector<FrontalScalar> weak;
  std::erase_if(told_, [&](const Told& told) {
    if (!graph.contains(told.variable) || tree.cliqueOf(told.variable) < 0) return true;
    weak.clear();
    appendWeakScalars(tree, tree.cliqueOf(told.variable), kWeakPivot, weak);
    return weak.empty();
  });
}

void SolverExplanations::forget(VariableId v) {
  std::erase_if(told_, [&](const Told& told) { return told.variable == v; });
}

}  // namespace motorcade
