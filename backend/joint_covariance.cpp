#include <algorithm>

#include "backend/incremental_solver.hpp"

namespace motorcade {

/// With the information H = L L^T and E the chosen columns of the identity, E^T H^-1 E = Y^T Y, Y = L^-1 E. Forward substitution meets only
/// the cliques from the chosen variables up to the root; no back-substitution is needed.
std::optional<Eigen::MatrixXd> IncrementalSolver::jointCovariance(std::span<const VariableId> variables) const {
  std::vector<int> start;
  for (const VariableId v : variables) {
    if (tree_.cliqueOf(v) < 0) return std::nullopt;
    start.push_back(tree_.cliqueOf(v));
  }
  std::vector<int> path = withAncestors(std::move(start));
  std::ranges::sort(path, {}, [&](int c) { return tree_.sequence(tree_[c].variables.front()); });

  std::vector<int> row(graph_.slots(), -1);
  int rows = 0, columns = 0;
  for (const int c : path)
    for (const VariableId v : tree_[c].frontalVariables()) {
      row[static_cast<std::size_t>(v.value)] = rows;
      rows += graph_.sizeOf(v);
    }
  for (const VariableId v : variables) columns += graph_.sizeOf(v);
  Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(rows, columns);  // right-hand side that is left after the cliques so far
  int column = 0;
  for (const VariableId v : variables) {
    rest.block(row[static_cast<std::size_t>(v.value)], column, graph_.sizeOf(v), graph_.sizeOf(v)).setIdentity();
    column += graph_.sizeOf(v);
  }

  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(columns, columns);
  for (const int c : path) {
    const Clique& clique = tree_[c];
    const int n = clique.frontal_size;
    auto y = rest.middleRows(row[static_cast<std::size_t>(clique.variables.front().value)], n);
    clique.L.topRows(n).triangularView<Eigen::Lower>().solveInPlace(y);
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(y.transpose());
    const Eigen::MatrixXd passed = clique.L.middleRows(n, clique.size - n) * y;
    int at = 0;
    for (const VariableId v : clique.separator()) {
      rest.middleRows(row[static_cast<std::size_t>(v.value)], graph_.sizeOf(v)) -= passed.middleRows(at, graph_.sizeOf(v));
      at += graph_.sizeOf(v);
    }
  }
  covariance.triangularView<Eigen::StrictlyUpper>() = covariance.transpose();
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

}  // namespace motorcade
