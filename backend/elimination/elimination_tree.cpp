#include "backend/elimination/elimination_tree.hpp"

#include <algorithm>
#include <cassert>

#include "backend/elimination/dense_kernels.hpp"

namespace motorcade {
namespace {

std::size_t panelLength(const Clique& c) { return c.panelStride() * c.frontal_size; }
std::size_t remainderLength(const Clique& c) { return c.separatorSize() * (c.separatorSize() + 1) / 2; }

/// With the 4 x 4 blocks on the diagonal whole, as the kernels read them.
void clearLowerTriangle(double* matrix, int stride, int columns) {
  for (int j = 0; j < columns; ++j, matrix += stride) std::fill(matrix + j / 4 * 4, matrix + stride, 0.0);
}

/// Mostly the six or three scalars of a pose.
inline void addTo(double* to, const double* from, int count) {
  if (count == 6) {
    for (int i = 0; i < 6; ++i) to[i] += from[i];
  } else if (count == 3) {
    for (int i = 0; i < 3; ++i) to[i] += from[i];
  } else {
    for (int i = 0; i < count; ++i) to[i] += from[i];
  }
}

}  // namespace

int EliminationTree::cliqueOf(VariableId v) const {
  return static_cast<std::size_t>(v.value) < clique_of_.size() ? clique_of_[v.value] : -1;
}

int EliminationTree::ownerOf(const Factor& factor) const {
  const auto first = std::ranges::min_element(factor.variables(), {}, [&](VariableId v) { return sequence_[v.value]; });
  return cliqueOf(*first);
}

std::int64_t EliminationTree::sequence(int clique) const {
  // By the last frontal: the first may have joined its parent's clique past others.
  return sequence_[(*this)[clique].frontalVariables().back().value];
}

void EliminationTree::appendCliquesWith(VariableId v, std::vector<int>& found) const {
  std::size_t next = found.size();
  if (cliqueOf(v) < 0) return;
  found.push_back(cliqueOf(v));
  for (; next < found.size(); ++next)
    for (int child = (*this)[found[next]].first_child; child >= 0; child = (*this)[child].next_sibling)
      if (std::ranges::find((*this)[child].separator(), v) != (*this)[child].separator().end()) found.push_back(child);
}

void EliminationTree::Removed::clear() {
  variables.clear();
  factors.clear();
  orphans.clear();
}

void EliminationTree::remove(std::span<const int> cliques, Removed& removed) {
  leaving_.resize(cliques_.size(), 0);
  for (const int id : cliques) leaving_[id] = 1;
  for (const int id : cliques) {
    Clique& clique = cliques_[id];
    for (const VariableId v : clique.frontalVariables()) {
      removed.variables.push_back(v);
      clique_of_[v.value] = -1;
    }
    removed.factors.insert(removed.factors.end(), clique.factors.begin(), clique.factors.end());
    for (int child = clique.first_child; child >= 0; child = cliques_[child].next_sibling)
      if (!leaving_[child]) removed.orphans.push_back(child);
    const bool below_one_that_stays = clique.parent >= 0 && !leaving_[clique.parent];
    if (below_one_that_stays) {
      if (clique.previous_sibling >= 0)
        cliques_[clique.previous_sibling].next_sibling = clique.next_sibling;
      else
        cliques_[clique.parent].first_child = clique.next_sibling;
      if (clique.next_sibling >= 0) cliques_[clique.next_sibling].previous_sibling = clique.previous_sibling;
    }
  }
  for (const int orphan : removed.orphans) {
    Clique& clique = cliques_[orphan];
    clique.parent = clique.next_sibling = clique.previous_sibling = -1;
  }
  std::erase_if(roots_, [&](int root) { return leaving_[root] != 0; });
  for (const int id : cliques) {
    leaving_[id] = 0;
    release(cliques_[id]);
    free_.push_back(id);
  }
  std::ranges::sort(removed.variables, {}, [&](VariableId v) { return sequence_[v.value]; });
}

void EliminationTree::release(Clique& clique) {
  pool_.give(clique.panel, panelLength(clique));
  pool_.give(clique.remainder, remainderLength(clique));
  pool_.give(clique.carry, clique.separatorSize());
  clique.variables.clear();
  clique.row_in_parent.clear();
  clique.factors.clear();
  clique.singular.clear();
  clique.panel = clique.remainder = clique.carry = nullptr;
  clique.parent = clique.first_child = clique.next_sibling = clique.previous_sibling = -1;
  clique.alive = false;
}

int EliminationTree::newClique() {
  int id = static_cast<int>(cliques_.size());
  if (free_.empty()) {
    cliques_.emplace_back();
  } else {
    id = free_.back();
    free_.pop_back();
  }
  cliques_[id].alive = true;
  return id;
}

void EliminationTree::attach(int orphan, int parent) {
  Clique &child = cliques_[orphan], &above = cliques_[parent];
  child.parent = parent;
  child.previous_sibling = -1;
  child.next_sibling = above.first_child;
  if (above.first_child >= 0) cliques_[above.first_child].previous_sibling = orphan;
  above.first_child = orphan;
  child.row_in_parent.clear();
  int at = 0;
  for (const VariableId v : above.variables) {
    offset_[v.value] = at;
    at += graph_.sizeOf(v);
  }
  for (const VariableId v : child.separator()) child.row_in_parent.push_back(offset_[v.value]);
}

void EliminationTree::forget(VariableId v) {
  clique_of_[v.value] = -1;
  sequence_[v.value] = -1;
}

void EliminationTree::removeFactor(int owner, FactorId factor) { std::erase(cliques_[owner].factors, factor); }

void EliminationTree::clearFindings() {
  singular_.clear();
  weakest_ = {};
}

void EliminationTree::eliminate(const Elimination& problem, std::vector<int>& created) {
  clique_of_.resize(graph_.slots(), -1);
  sequence_.resize(graph_.slots(), -1);
  offset_.resize(graph_.slots(), -1);
  if (problem.renumber)
    for (const VariableId v : problem.order) sequence_[v.value] = next_sequence_++;

  const int count = static_cast<int>(problem.order.size());
  auto& position = offset_;
  scalars_.clear();
  for (const VariableId v : problem.order)
    position[v.value] = static_cast<int>(scalars_.size()), scalars_.push_back(graph_.sizeOf(v));
  for (const VariableId v : problem.boundary)
    position[v.value] = static_cast<int>(scalars_.size()), scalars_.push_back(graph_.sizeOf(v));
  pattern_.begin(count, static_cast<int>(problem.boundary.size()));
  const auto addTerm = [&](std::span<const VariableId> variables) {
    term_positions_.clear();
    for (const VariableId v : variables) term_positions_.push_back(position[v.value]);
    pattern_.addTerm(term_positions_);
  };
  for (const FactorId f : problem.factors) addTerm(graph_.factor(f).variables());
  for (const int orphan : problem.orphans) addTerm((*this)[orphan].separator());
  pattern_.analyze(scalars_);

  group_clique_.clear();
  const std::size_t first = created.size();
  for (const auto& group : pattern_.groups()) {
    const int id = newClique();
    group_clique_.push_back(id);
    created.push_back(id);
    Clique& clique = cliques_[id];
    clique.frontals = group.frontals;
    for (const int p : pattern_.positions(group))
      clique.variables.push_back(p < count ? problem.order[p] : problem.boundary[p - count]);
    for (const VariableId v : clique.frontalVariables()) clique_of_[v.value] = id;
    layOut(clique);
  }
  for (std::size_t f = 0; f < problem.factors.size(); ++f)
    cliques_[group_clique_[pattern_.groupOfTerm(static_cast<int>(f))]].factors.push_back(problem.factors[f]);
  // From here on `offset_` serves the fronts.
  for (std::size_t g = 0; g < pattern_.groups().size(); ++g) {
    const int above = pattern_.groups()[g].parent, parent = above < 0 ? problem.parent : group_clique_[above];
    if (parent >= 0)
      attach(group_clique_[g], parent);
    else
      roots_.push_back(group_clique_[g]);
  }
  for (std::size_t o = 0; o < problem.orphans.size(); ++o)
    attach(problem.orphans[o], group_clique_[pattern_.groupOfTerm(static_cast<int>(problem.factors.size() + o))]);
  for (std::size_t i = created.size(); i-- > first;) refresh(created[i]);
}

/// Sizes and memory of a clique from its variables.
void EliminationTree::layOut(Clique& clique) {
  clique.frontal_size = clique.size = 0;
  for (std::size_t i = 0; i < clique.variables.size(); ++i) {
    clique.size += graph_.sizeOf(clique.variables[i]);
    if (static_cast<int>(i) < clique.frontals) clique.frontal_size = clique.size;
  }
  clique.panel = pool_.take(panelLength(clique));
  clique.remainder = pool_.take(remainderLength(clique));
  clique.carry = pool_.take(clique.separatorSize());
}

Eigen::MatrixXd EliminationTree::marginal(std::span<const VariableId> eliminated, std::span<const VariableId> separator,
                                          std::span<const FactorId> factors) {
  Clique clique;
  clique.variables.assign(eliminated.begin(), eliminated.end());
  clique.variables.insert(clique.variables.end(), separator.begin(), separator.end());
  clique.factors.assign(factors.begin(), factors.end());
  clique.frontals = static_cast<int>(eliminated.size());
  layOut(clique);
  eliminateFront(clique);
  const int rows = clique.separatorSize() + 1;
  const Eigen::MatrixXd result = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>(
      remainder_.data(), rows, rows, Eigen::OuterStride<>(remainder_stride_));
  release(clique);
  return result;
}

void EliminationTree::refresh(int id) {
  Clique& clique = cliques_[id];
  eliminateFront(clique);
  eliminated_scalars_ += clique.frontal_size;
}

/// Gathers the front, factorizes it, and holds what has no information.
void EliminationTree::eliminateFront(Clique& clique) {
  const int n = clique.frontal_size, rest = clique.separatorSize(), stride = clique.panelStride();
  remainder_stride_ = (rest + 1 + 3) / 4 * 4;
  if (const std::size_t length = remainder_stride_ * (rest + 1); remainder_.size() < length) remainder_.resize(length);
  clearLowerTriangle(clique.panel, stride, n);
  clearLowerTriangle(remainder_.data(), remainder_stride_, rest + 1);
  int at = 0;
  for (const VariableId v : clique.variables) {
    offset_[v.value] = at;
    at += graph_.sizeOf(v);
  }
  for (const FactorId f : clique.factors) addFactorTo(clique, f);
  for (int child = clique.first_child; child >= 0; child = cliques_[child].next_sibling)
    addChildTo(clique, cliques_[child]);

  clique.singular.clear();
  const double ratio = factorizePanel(clique.panel, stride, clique.size + 1, n, clique.singular);
  subtractOuterProduct(remainder_.data(), remainder_stride_, clique.panel + n, stride, rest + 1, n);
  packRemainder(clique);
  if (ratio < weakest_.ratio) weakest_ = {.variable = clique.variables.front(), .ratio = ratio};
  for (const int column : clique.singular) holdSingular(clique, column);
}

void EliminationTree::packRemainder(Clique& clique) const {
  const int rest = clique.separatorSize();
  const double* from = remainder_.data();
  double* to = clique.remainder;
  for (int j = 0; j < rest; ++j, from += remainder_stride_) {
    to = std::copy(from + j, from + rest, to);
    clique.carry[j] = from[rest];
  }
}

/// Keeps the x of a scalar without information where the estimate stands.
void EliminationTree::holdSingular(Clique& clique, int column) {
  std::size_t v = 0;
  int component = column;
  while (component >= graph_.sizeOf(clique.variables[v])) component -= graph_.sizeOf(clique.variables[v++]);
  const VariableId variable = clique.variables[v];
  singular_.push_back({variable, component});
  clique.panel[column * clique.panelStride() + clique.size] = -graph_[variable].x[component];
}

/// A column of the front's lower triangle, such that [row] is the entry.
double* EliminationTree::column(Clique& clique, int column) {
  const int n = clique.frontal_size;
  if (column < n) return clique.panel + column * clique.panelStride();
  return remainder_.data() + (column - n) * remainder_stride_ - n;
}

/// Adds the lower triangle of a small symmetric matrix whose rows are given in spans; `source` gives its columns.
template <class ColumnOf>
void EliminationTree::addSymmetric(Clique& clique, const ColumnOf& source, std::span<const RowSpan> spans) {
  for (std::size_t b = 0; b < spans.size(); ++b) {
    const RowSpan columns = spans[b];
    const std::span<const RowSpan> below = spans.subspan(b + 1);
    for (int j = 0; j < columns.size; ++j) {
      const double* from = source(columns.from + j);
      double* to = column(clique, columns.to + j);
      addTo(to + columns.to + j, from + columns.from + j, columns.size - j);
      for (const RowSpan& rows : below) {
        if (rows.to > columns.to)
          addTo(to + rows.to, from + rows.from, rows.size);
        else  // above the diagonal
          for (int i = 0; i < rows.size; ++i) column(clique, rows.to + i)[columns.to + j] += from[rows.from + i];
      }
    }
  }
}

void EliminationTree::addFactorTo(Clique& clique, FactorId id) {
  const Factor& factor = graph_.factor(id);
  const auto term = graph_.term(id);
  spans_.clear();
  int from = 0;
  for (const VariableId v : factor.variables()) {
    spans_.push_back({from, offset_[v.value], graph_.sizeOf(v)});
    from += graph_.sizeOf(v);
  }
  spans_.push_back({from, clique.size, 1});
  if (factor.form() == Factor::Form::kInformation) {
    addSymmetric(
        clique, [&](int j) { return term.data() + j * term.rows(); }, spans_);
    return;
  }
  const int columns = static_cast<int>(term.cols()), stride = (columns + 3) / 4 * 4;
  product_.assign(columns * stride, 0.0);
  addJacobianProduct(term.data(), static_cast<int>(term.rows()), columns, product_.data(), stride);
  addSymmetric(
      clique, [&](int j) { return product_.data() + j * stride; }, spans_);
}

void EliminationTree::addChildTo(Clique& clique, const Clique& child) {
  spans_.clear();
  int from = 0;
  const auto separator = child.separator();
  for (std::size_t i = 0; i < separator.size(); ++i) {
    const int to = child.row_in_parent[i], size = graph_.sizeOf(separator[i]);
    if (!spans_.empty() && spans_.back().to + spans_.back().size == to)
      spans_.back().size += size;
    else
      spans_.push_back({from, to, size});
    from += size;
  }
  splitAtFrontals(clique.frontal_size);
  addSymmetric(
      clique, [&](int j) { return child.remainderColumn(j); }, spans_);
  // The right-hand side, which `carry` holds when it changed alone.
  for (const RowSpan& span : spans_)
    for (int i = 0; i < span.size; ++i) column(clique, span.to + i)[clique.size] += child.carry[span.from + i];
}

/// A span must not reach across the border between panel and remainder.
void EliminationTree::splitAtFrontals(int frontal_size) {
  for (std::size_t i = 0; i < spans_.size(); ++i) {
    RowSpan& span = spans_[i];
    const int inside = frontal_size - span.to;
    if (inside <= 0 || inside >= span.size) continue;
    const RowSpan rest{span.from + inside, span.to + inside, span.size - inside};
    span.size = inside;
    spans_.insert(spans_.begin() + static_cast<std::ptrdiff_t>(i) + 1, rest);
    return;
  }
}

void EliminationTree::shiftRightHandSide(int id, std::span<double> change, std::span<double> parent_change) {
  Clique& clique = cliques_[id];
  const int n = clique.frontal_size, rest = clique.separatorSize(), stride = clique.panelStride();
  // d of the change alone, then added to the former d.
  former_.resize(n);
  double* last_row = clique.panel + clique.size;
  for (int j = 0; j < n; ++j) former_[j] = last_row[j * stride];
  double cost = 0;  // nobody asks for it
  forwardSubstitute(clique.panel, stride, clique.size + 1, n, clique.singular, change.data(), cost);
  for (int j = 0; j < n; ++j) last_row[j * stride] += former_[j];
  for (int i = 0; i < rest; ++i) clique.carry[i] += change[n + i];
  if (parent_change.empty()) return;  // none, or one that is eliminated anew
  int from = n;
  const auto separator = clique.separator();
  for (std::size_t v = 0; v < separator.size(); ++v) {
    const int to = clique.row_in_parent[v], size = graph_.sizeOf(separator[v]);
    for (int i = 0; i < size; ++i) parent_change[to + i] += change[from + i];
    from += size;
  }
}

}  // namespace motorcade
