#include <algorithm>

#include "backend/solver/incremental_solver.hpp"

namespace motorcade {

/// With the information H = L L^T and E the chosen columns of the identity, E^T H^-1 E = Y^T Y, Y = L^-1 E. Forward
/// substitution meets only the cliques from the chosen variables up to the root; no back-substitution is needed.
std::optional<Eigen::MatrixXd> IncrementalSolver::jointCovariance(std::span<const VariableId> variables) const {
  std::vector<int> start;
  for (const VariableId v : variables) {
    if (tree_.cliqueOf(v) < 0) return std::nullopt;
    start.push_back(tree_.cliqueOf(v));
  }
  std::vector<int> path = withAncestors(std::move(start));
  std::ranges::sort(path, {}, [&](int c) { return tree_.sequence(c); });

  std::vector<int> row(graph_.slots(), -1);
  int rows = 0, columns = 0;
  for (const int c : path)
    for (const VariableId v : tree_[c].frontalVariables()) {
      row[v.value] = rows;
      rows += graph_.sizeOf(v);
    }
  for (const VariableId v : variables) columns += graph_.sizeOf(v);
  Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(rows, columns);  // right-hand side that is left after the cliques so far
  int column = 0;
  for (const VariableId v : variables) {
    rest.block(row[v.value], column, graph_.sizeOf(v), graph_.sizeOf(v)).setIdentity();
    column += graph_.sizeOf(v);
  }

  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(columns, columns);
  for (const int c : path) {
    const Clique& clique = tree_[c];
    if (!clique.singular.empty()) return std::nullopt;
    const int n = clique.frontal_size;
    const Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> L(clique.panel, clique.size, n,
                                                                       Eigen::OuterStride<>(clique.panelStride()));
    auto y = rest.middleRows(row[clique.variables.front().value], n);
    L.topRows(n).triangularView<Eigen::Lower>().solveInPlace(y);
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(y.transpose());
    const Eigen::MatrixXd passed = L.bottomRows(clique.separatorSize()) * y;
    int at = 0;
    for (const VariableId v : clique.separator()) {
      rest.middleRows(row[v.value], graph_.sizeOf(v)) -= passed.middleRows(at, graph_.sizeOf(v));
      at += graph_.sizeOf(v);
    }
  }
  covariance.triangularView<Eigen::StrictlyUpper>() = covariance.transpose();
  if (!covariance.allFinite()) return std::nullopt;
  // From steps in the world's axes to right perturbations.
  column = 0;
  for (const VariableId v : variables) {
    const auto turn = [&]<int N>(const Eigen::Matrix<double, N, N>& R, int at) {
      covariance.middleRows<N>(at) = (R.transpose() * covariance.middleRows<N>(at)).eval();
      covariance.middleCols<N>(at) = (covariance.middleCols<N>(at) * R).eval();
    };
    const Value value = graph_.estimate(v);
    if (const auto* pose = std::get_if<SE3>(&value)) {
      turn(pose->rotation(), column);
      turn(pose->rotation(), column + 3);
    } else if (const auto* planar = std::get_if<SE2>(&value)) {
      turn(planar->rotation(), column);
    }
    column += graph_.sizeOf(v);
  }
  return covariance;
}

}  // namespace motorcade
