#include "backend/elimination/variable_lift.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "backend/elimination/row_update.hpp"

namespace motorcade {
namespace {

/// Row of a scalar when `moved` of them, from `begin` on, are put behind those before `end`.
int rowAfterRotation(int row, int begin, int moved, int end) {
  if (row < begin || row >= end) return row;
  return row < begin + moved ? row + (end - begin - moved) : row - moved;
}

}  // namespace

void VariableLift::moveToEnd(int id, VariableId v) {
  Clique& clique = tree_[id];
  const int count = graph_.sizeOf(v), n = clique.frontal_size, ld = clique.panelStride();
  const auto at = std::ranges::find(clique.variables, v);
  int begin = 0;
  for (auto u = clique.variables.begin(); u != at; ++u) begin += graph_.sizeOf(*u);
  if (begin + count == n) return;
  std::rotate(at, at + 1, clique.variables.begin() + clique.frontals);
  for (int child = clique.first_child; child >= 0; child = tree_[child].next_sibling)
    for (int& row : tree_[child].row_in_parent) row = rowAfterRotation(row, begin, count, n);
  added_.assign(std::size_t(ld) * count, 0.0);
  for (int k = 0; k < count; ++k) {
    const double* const column = clique.panel + std::size_t(begin + k) * ld;
    for (int row = begin + k; row <= clique.size; ++row)
      added_[std::size_t(k) * ld + rowAfterRotation(row, begin, count, n)] = column[row];
  }
  for (int j = 0; j < begin; ++j) {
    double* const column = clique.panel + std::size_t(j) * ld;
    std::rotate(column + begin, column + begin + count, column + n);
  }
  for (int j = begin; j < n - count; ++j) {
    const double* const from = clique.panel + std::size_t(j + count) * ld;
    double* const to = clique.panel + std::size_t(j) * ld;
    std::copy(from + j + count, from + n, to + j);
    std::fill(to + n - count, to + n, 0.0);
    std::copy(from + n, from + clique.size + 1, to + n);
  }
  std::fill(clique.panel + std::size_t(n - count) * ld, clique.panel + std::size_t(n) * ld, 0.0);
  addRows(clique.panelView(), begin, added_.data(), count);
}

void VariableLift::moveToParent(int id) {
  Clique &clique = tree_[id], &parent = tree_[clique.parent];
  const VariableId v = clique.frontalVariables().back();
  const int count = graph_.sizeOf(v);
  takeRows(clique, count);
  takeIn(parent, clique, count);
  for (int child = parent.first_child; child >= 0; child = tree_[child].next_sibling)
    for (int& row : tree_[child].row_in_parent)
      if (row >= parent.frontal_size) row += count;
  clique.row_in_parent.insert(clique.row_in_parent.begin(), parent.frontal_size);
  parent.frontal_size += count, parent.size += count;
  clique.frontal_size -= count;
  tree_.moveFrontalUp(id);
  moveFactors(id);
  if (clique.frontals > 0) passOn(clique, count);
}

/// Moves the factors without a frontal variable of the clique to its parent.
void VariableLift::moveFactors(int id) {
  auto& factors = tree_[id].factors;
  const auto stays = [&](FactorId f) {
    return std::ranges::any_of(graph_.variablesOf(f), [&](VariableId u) { return tree_.cliqueOf(u) == id; });
  };
  const auto moved = std::stable_partition(factors.begin(), factors.end(), stays);
  moved_.assign(moved, factors.end());
  factors.erase(moved, factors.end());
  for (const FactorId f : moved_) tree_.addFactor(tree_[id].parent, f);
}

/// Takes the rows of the last frontal scalars: a column each of those scalars, the separator, and d.
void VariableLift::takeRows(const Clique& clique, int count) {
  const int first = clique.frontal_size - count, length = clique.size + 1 - first;
  rows_.assign(std::size_t(length) * count, 0.0);
  for (int k = 0; k < count; ++k) {
    const double* const column = clique.panel + std::size_t(first + k) * clique.panelStride() + first;
    std::copy(column + k, column + length, rows_.begin() + std::ptrdiff_t(k) * length + k);
  }
}

/// Adds the rows to those of the parent, behind whose frontals the scalars come.
void VariableLift::takeIn(Clique& parent, const Clique& clique, int count) {
  const int n = parent.frontal_size, size = parent.size + count, ld = padded(size + 1);
  const int length = clique.separatorSize() + count + 1;
  const std::size_t doubles = std::size_t(ld) * (n + count);
  double* const former = parent.panel;
  const bool stays = BlockPool::fits(former, doubles);
  double* const panel = parent.panel = stays ? former : panels_.takeToGrow(doubles);
  for (int j = n - 1; j >= 0; --j) {  // in place, what is read is not overwritten
    const double* const from = former + std::size_t(j) * parent.panelStride();
    double* const to = panel + std::size_t(j) * ld;
    std::memmove(to + n + count, from + n, (parent.size + 1 - n) * sizeof(double));
    std::memmove(to + j, from + j, (n - j) * sizeof(double));
    std::fill(to + n, to + n + count, 0.0);
  }
  if (!stays) panels_.give(former);
  std::fill(panel + std::size_t(n) * ld, panel + std::size_t(n + count) * ld, 0.0);
  added_.assign(std::size_t(ld) * count, 0.0);
  int first = n;
  const auto add = [&](int from, int to, int scalars) {
    first = std::min(first, to);
    for (int k = 0; k < count; ++k)
      std::copy_n(rows_.begin() + std::ptrdiff_t(k) * length + from, scalars,
                  added_.begin() + std::ptrdiff_t(k) * ld + to);
  };
  add(0, n, count);
  int from = count;
  const auto separator = clique.separator();
  for (std::size_t i = 0; i < separator.size(); ++i) {
    const int row = clique.row_in_parent[i], scalars = graph_.sizeOf(separator[i]);
    add(from, row < n ? row : row + count, scalars);
    from += scalars;
  }
  add(from, size, 1);
  addRows({.data = panel, .ld = ld, .rows = size + 1, .columns = n + count}, first, added_.data(), count);
}

/// Makes the clique pass on what the rows that left it say, but for the factors that went with them.
void VariableLift::passOn(Clique& clique, int count) {
  const int size = clique.separatorSize(), length = size + 1;
  double* const contribution = panels_.take(size);
  for (int i = 0; i < size; ++i) {
    contribution[i] = i < count ? 0 : clique.contribution[i - count];
    for (int k = 0; k < count; ++k)
      contribution[i] += rows_[std::size_t(k) * length + i] * rows_[std::size_t(k) * length + size];
  }
  panels_.give(std::exchange(clique.contribution, contribution));
  if (clique.update_matrix)
    update_matrices_.grow(
        clique, [&](double* to, const double* from) { growByProduct(to, size, from, rows_.data(), length, count); });
  for (const FactorId f : moved_) leaveOut(clique, f);
}

/// Takes a factor's term out of what the clique passes on.
void VariableLift::leaveOut(Clique& clique, FactorId id) {
  row_.clear();
  for (const VariableId v : graph_.variablesOf(id)) {
    int row = 0;
    for (const VariableId u : clique.separator()) {
      if (u == v) break;
      row += graph_.sizeOf(u);
    }
    for (int i = 0; i < graph_.sizeOf(v); ++i) row_.push_back(row + i);
  }
  const LinearModels& models = graph_.models();
  const int n = static_cast<int>(row_.size()), size = clique.separatorSize();
  const auto subtract = [&](int j, const double* column, double g) {
    clique.contribution[row_[j]] -= g;
    for (int i = j; i < n && clique.update_matrix; ++i) {
      const auto [above, below] = std::minmax(row_[i], row_[j]);
      clique.update_matrix[PackedTriangle::offset(size, above) + below] -= column[i];
    }
  };
  if (!models.isJacobian(id)) {
    const auto information = models.information(id);
    for (int j = 0; j < n; ++j) subtract(j, information.H.column(j), information.g_c[j]);
    return;
  }
  const auto term = models.term(id);
  const int stride = padded(n + 1);
  product_.assign(std::size_t(n + 1) * stride, 0.0);
  addJacobianProduct(term.data(), static_cast<int>(term.rows()), n + 1, product_.data(), stride);
  for (int j = 0; j < n; ++j) subtract(j, &product_[std::size_t(j) * stride], product_[std::size_t(j) * stride + n]);
}

}  // namespace motorcade
