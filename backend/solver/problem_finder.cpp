#include "backend/solver/problem_finder.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "backend/graph/sort_unique.hpp"

namespace motorcade {
namespace {

using Kind = SolverProblem::Kind;
using Constraint = NullSpaceDirection::Constraint;
using Directions = std::vector<const NullSpaceDirection*>;

/// Number of variables below a root; a connected part of the graph has one root.
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

/// Basis of the columns' span with as many zeros as it can have, each of unit length.
std::vector<SmallVector> sparseBasis(Eigen::MatrixXd columns) {
  constexpr double kRounding = 1e-7;  // of the largest entry: the columns come from weak pivots
  const double largest = columns.cwiseAbs().maxCoeff();
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pivots;  // row, column
  Eigen::MatrixXd rest = columns;
  while (static_cast<Eigen::Index>(pivots.size()) < columns.cols()) {
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

/// Turns a step in the world's axes into the variable's own perturbation, where its Jacobians were taken.
SmallVector toOwnAxes(const FactorGraph& graph, VariableId v, SmallVector step) {
  const Value& value = graph.states()[v].linearization_point;
  if (const auto* pose = std::get_if<SE3>(&value)) {
    step.head<3>() = (pose->rotation().transpose() * step.head<3>()).eval();
    step.tail<3>() = (pose->rotation().transpose() * step.tail<3>()).eval();
  } else if (const auto* planar = std::get_if<SE2>(&value)) {
    step.head<2>() = (planar->rotation().transpose() * step.head<2>()).eval();
  }
  return step;
}

/// The variable held in most directions; of several such, the one whose direction comes last.
VariableId mostHeld(const Directions& directions) {
  const auto times = [&](VariableId v) { return std::ranges::count(directions, v, &NullSpaceDirection::held); };
  VariableId most = directions.front()->held;
  for (const NullSpaceDirection* direction : directions)
    if (times(direction->held) >= times(most)) most = direction->held;
  return most;
}

/// Merges directions that belong together into one problem.
SolverProblem merged(const FactorGraph& graph, Kind kind, const Directions& directions, std::int64_t part_variables) {
  const VariableId v = mostHeld(directions);
  SolverProblem problem{.kind = kind, .variable = v, .factors = graph.factorsOf(v)};
  problem.part_variables = part_variables;
  problem.freedoms = static_cast<std::int64_t>(directions.size());
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(graph.sizeOf(v), static_cast<Eigen::Index>(directions.size()));
  std::vector<VariableId> moving;
  Eigen::Index column = 0;
  for (const NullSpaceDirection* direction : directions) {
    for (const auto& [u, step] : direction->steps) {
      moving.push_back(u);
      if (u == v) own.col(column) = toOwnAxes(graph, v, step);
    }
    ++column;
  }
  problem.directions = sparseBasis(own);
  sortUnique(moving);
  problem.moving_variables = static_cast<std::int64_t>(moving.size());
  return problem;
}

Kind kindOf(const NullSpaceDirection& direction) {
  if (direction.constraint == Constraint::kNegative) return Kind::kIndefinite;
  return direction.constraint == Constraint::kWeak ? Kind::kBadlyConditioned : Kind::kUnconstrained;
}

/// True when no factor constrains the direction, and several variables move along it or the one that moves has no
/// factors.
bool isJoint(const FactorGraph& graph, const NullSpaceDirection& direction) {
  return direction.constraint == Constraint::kNone &&
         (direction.steps.size() > 1 || graph.factorsOf(direction.held).empty());
}

/// Problems of one connected part.
std::vector<SolverProblem> problemsOfPart(const FactorGraph& graph, const std::vector<NullSpaceDirection>& directions,
                                          std::int64_t part_variables) {
  const bool whole_part_moves = std::ranges::any_of(directions, [&](const NullSpaceDirection& d) {
    return isJoint(graph, d) && static_cast<std::int64_t>(d.steps.size()) == part_variables;
  });
  Directions of_part;
  std::map<std::pair<VariableId, Kind>, Directions> of_variables;
  for (const NullSpaceDirection& direction : directions) {
    if (whole_part_moves && isJoint(graph, direction))
      of_part.push_back(&direction);
    else
      of_variables[{direction.held, kindOf(direction)}].push_back(&direction);
  }
  std::vector<SolverProblem> problems;
  if (!of_part.empty()) problems.push_back(merged(graph, Kind::kMissingPrior, of_part, part_variables));
  for (const auto& [key, of_variable] : of_variables)
    problems.push_back(merged(graph, key.second, of_variable, part_variables));
  return problems;
}

/// Weak scalars by the root of their connected part.
std::map<int, std::vector<FrontalScalar>> weakScalarsOfParts(const EliminationTree& tree) {
  std::map<int, std::vector<FrontalScalar>> parts;
  for (const int clique : tree.cliques()) {
    const auto found = weakScalars(tree, clique, kWeakPivot);
    if (found.empty()) continue;
    auto& part = parts[tree.rootOf(clique)];
    part.insert(part.end(), found.begin(), found.end());
  }
  return parts;
}

}  // namespace

bool concernsPart(Kind kind) { return kind == Kind::kMissingPrior || kind == Kind::kDisconnectedPart; }

std::vector<SolverProblem> findProblems(const FactorGraph& graph, const EliminationTree& tree) {
  std::vector<SolverProblem> problems;
  std::size_t free_parts = 0;
  for (const auto& [root, scalars] : weakScalarsOfParts(tree)) {
    std::vector<NullSpaceDirection> directions;
    for (const FrontalScalar& scalar : scalars) directions.push_back(nullSpaceDirection(graph, tree, scalar));
    const auto of_part = problemsOfPart(graph, directions, variablesBelow(tree, root));
    if (std::ranges::any_of(of_part, concernsPart, &SolverProblem::kind)) ++free_parts;
    problems.insert(problems.end(), of_part.begin(), of_part.end());
  }
  if (free_parts < tree.roots().size())
    for (SolverProblem& problem : problems)
      if (problem.kind == Kind::kMissingPrior) problem.kind = Kind::kDisconnectedPart;
  std::ranges::sort(problems, {}, &SolverProblem::variable);
  return problems;
}

}  // namespace motorcade
