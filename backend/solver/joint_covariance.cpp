#include "backend/solver/joint_covariance.hpp"

#include <algorithm>

#include "backend/elimination/dense_substitution.hpp"

namespace motorcade {
namespace {

/// The cliques from some variables up to the root, children first, and where their frontal variables stand in a vector
/// of all their frontal scalars.
struct Path {
  struct First {
    VariableId variable;
    int row;  // of the variable's first scalar
  };
  std::vector<int> cliques;
  std::vector<First> first;  // in order of variables
  int rows = 0;

  int rowOf(VariableId v) const { return std::ranges::lower_bound(first, v, {}, &First::variable)->row; }
};

Path pathFrom(const FactorGraph& graph, const EliminationTree& tree, std::span<const VariableId> variables) {
  std::vector<int> start;
  for (const VariableId v : variables) start.push_back(tree.cliqueOf(v));
  Path path{.cliques = tree.withAncestors(std::move(start)), .first = {}};
  std::ranges::sort(path.cliques, {}, [&](int c) { return tree.sequence(c); });
  for (const int c : path.cliques)
    for (const VariableId v : tree[c].frontalVariables()) {
      path.first.push_back({v, path.rows});
      path.rows += graph.sizeOf(v);
    }
  std::ranges::sort(path.first, {}, &Path::First::variable);
  return path;
}

using RowMajorMatrixXd = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Turns the rows of right perturbations to those of steps in the world's axes.
void turnToWorldAxes(const Value& value, RowMajorMatrixXd& rows) {
  if (const auto* pose = std::get_if<SE3>(&value)) {
    rows.topRows<3>() = (pose->rotation() * rows.topRows<3>()).eval();
    rows.bottomRows<3>() = (pose->rotation() * rows.bottomRows<3>()).eval();
  } else if (const auto* planar = std::get_if<SE2>(&value)) {
    rows.topRows<2>() = (planar->rotation() * rows.topRows<2>()).eval();
  }
}

/// Columns of J^T in the rows of the path, which hold steps in the world's axes, and zeros that pad the rows. J acts on
/// right perturbations.
RowMajorMatrixXd transposed(const FactorGraph& graph, const Path& path, std::span<const VariableId> variables,
                            const Eigen::Ref<const Eigen::MatrixXd>& J) {
  RowMajorMatrixXd columns = RowMajorMatrixXd::Zero(path.rows, padded(static_cast<int>(J.rows())));
  Eigen::Index from = 0;
  for (const VariableId v : variables) {
    RowMajorMatrixXd of_variable = J.middleCols(from, graph.sizeOf(v)).transpose();
    turnToWorldAxes(graph.states().estimate(v), of_variable);
    columns.block(path.rowOf(v), 0, graph.sizeOf(v), J.rows()) += of_variable;
    from += graph.sizeOf(v);
  }
  return columns;
}

/// Finds the rows of the path for a clique's scalars, in the order of its factor.
void findRows(const FactorGraph& graph, const Path& path, const Clique& clique, std::vector<int>& rows) {
  rows.clear();
  for (const VariableId v : clique.variables)
    for (int i = 0, row = path.rowOf(v); i < graph.sizeOf(v); ++i) rows.push_back(row + i);
}

int firstRowThatIsNotZero(const Eigen::Ref<const RowMajorMatrixXd>& y, int rows) {
  int row = 0;
  while (row < rows && (y.row(row).array() == 0).all()) ++row;
  return row;
}

Panel lowerRight(const Panel& panel, int from) {
  return {.data = panel.data + std::ptrdiff_t{from} * (panel.ld + 1),
          .ld = panel.ld,
          .rows = panel.rows - from,
          .columns = panel.columns - from};
}

/// First row for each column in which it or a later column is not zero, or the number of rows.
std::vector<int> beginsOf(const RowMajorMatrixXd& columns) {
  std::vector<int> begins(columns.cols());
  int earliest = static_cast<int>(columns.rows());
  for (Eigen::Index column = columns.cols() - 1; column >= 0; --column) {
    int row = 0;
    while (row < earliest && columns(row, column) == 0) ++row;
    begins[column] = earliest = std::min(earliest, row);
  }
  return begins;
}

void copyFours(const double* from, double* to, int count) {
  for (int i = 0; i < count; i += 4) std::copy_n(from + i, 4, to + i);
}

/// Computes J H^-1 J^T = Y^T Y, Y = L^-1 J^T, from the information H = L L^T. Forward substitution meets only the
/// cliques from the variables of J up to the root; no back-substitution is needed. `rest` holds J^T, and what is left
/// of it after the cliques so far. Last columns that begin farther up are left out.
std::optional<Eigen::MatrixXd> squareOfSolution(const FactorGraph& graph, const EliminationTree& tree, const Path& path,
                                                RowMajorMatrixXd rest) {
  const std::vector<int> begins = beginsOf(rest);
  const int stride = static_cast<int>(rest.cols());
  Eigen::MatrixXd minus_square = Eigen::MatrixXd::Zero(stride, stride);
  std::vector<int> rows;
  int largest = 0, passed = 0, used = 0;
  for (const int c : path.cliques) largest = std::max(largest, tree[c].size);
  Eigen::VectorXd memory(Eigen::Index{largest} * stride);
  for (const int c : path.cliques) {
    const Clique& clique = tree[c];
    if (!clique.singular.empty()) return std::nullopt;
    findRows(graph, path, clique, rows);
    passed += clique.frontal_size;
    while (used < stride && begins[used] < passed) ++used;
    const int width = padded(used);
    Eigen::Map<RowMajorMatrixXd> y(memory.data(), clique.size, width);
    const auto row_of = [&](int i) { return rest.data() + std::ptrdiff_t{rows[i]} * stride; };
    for (int i = 0; i < clique.size; ++i) copyFours(row_of(i), y.data() + std::ptrdiff_t{i} * width, width);
    const int first = firstRowThatIsNotZero(y, clique.frontal_size), solved = clique.frontal_size - first;
    double* const from = y.data() + std::ptrdiff_t{first} * width;
    forwardSubstitute(lowerRight(clique.panelView(), first), from, width);
    subtractOuterProduct(minus_square.data(), stride, from, width, used, solved);
    for (int i = clique.frontal_size; i < clique.size; ++i)
      copyFours(y.data() + std::ptrdiff_t{i} * width, row_of(i), width);
  }
  Eigen::MatrixXd square = -minus_square;
  square.triangularView<Eigen::StrictlyUpper>() = square.transpose();
  return square;
}

}  // namespace

std::optional<Eigen::MatrixXd> jointCovariance(const FactorGraph& graph, const EliminationTree& tree,
                                               std::span<const VariableId> variables,
                                               const Eigen::Ref<const Eigen::MatrixXd>& J) {
  if (std::ranges::any_of(variables, [&](VariableId v) { return tree.cliqueOf(v) < 0; })) return std::nullopt;
  const Path path = pathFrom(graph, tree, variables);
  auto covariance = squareOfSolution(graph, tree, path, transposed(graph, path, variables, J));
  if (!covariance || !covariance->allFinite()) return std::nullopt;
  return covariance->topLeftCorner(J.rows(), J.rows());
}

}  // namespace motorcade
