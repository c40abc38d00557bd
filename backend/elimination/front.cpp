#include "backend/elimination/front.hpp"

#include <algorithm>

namespace motorcade {

double Front::eliminate(Clique& clique) {
  gather(clique, clique.panel);
  clique.singular.clear();
  const double ratio = factorizePanel(clique.panelView(), clique.singular);
  subtractEliminated(clique);
  packUpdateMatrix(clique);
  packContribution(clique);
  for (const int column : clique.singular) holdSingular(clique, column);
  return clique.singular.empty() ? ratio : 0;
}

void Front::makeUpdateMatrix(Clique& clique) {
  unneeded_panel_.resize(std::max(unneeded_panel_.size(), clique.panelLength()));
  gather(clique, unneeded_panel_.data());
  subtractEliminated(clique);
  packUpdateMatrix(clique);
}

void Front::gather(const Clique& clique, double* panel) {
  begin(clique, panel);
  for (const FactorId f : clique.factors) addFactor(clique, f);
  for (int child = clique.first_child; child >= 0; child = tree_[child].next_sibling) addChild(clique, tree_[child]);
}

/// Subtracts from the separator what the eliminated frontals take off it.
void Front::subtractEliminated(const Clique& clique) {
  const int n = clique.frontal_size;
  subtractOuterProduct(update_matrix_.data(), update_stride_, clique.panel + n, clique.panelStride(), update_size_, n);
}

/// Begins an empty front of the clique's size.
void Front::begin(const Clique& clique, double* panel) {
  update_size_ = clique.separatorSize() + 1;
  update_stride_ = padded(update_size_);
  const std::size_t length = std::size_t(update_stride_) * update_size_;
  if (update_matrix_.size() < length) update_matrix_.resize(length);
  clearLowerTriangle(panel, clique.panelStride(), clique.frontal_size);
  clearLowerTriangle(update_matrix_.data(), update_stride_, update_size_);
  columns_ = {.panel = panel,
              .panel_stride = clique.panelStride(),
              .panel_columns = clique.frontal_size,
              .update_matrix = update_matrix_.data(),
              .update_stride = update_stride_};
  offset_.resize(graph_.slots());
  int at = 0;
  for (const VariableId v : clique.variables) {
    offset_[v.value] = at;
    at += graph_.sizeOf(v);
  }
}

void Front::addFactor(const Clique& clique, FactorId id) {
  spans_.clear();
  int from = 0;
  for (const VariableId v : graph_.variablesOf(id)) {
    spans_.push_back({from, offset_[v.value], graph_.sizeOf(v)});
    from += graph_.sizeOf(v);
  }
  const LinearModels& models = graph_.models();
  if (!models.isJacobian(id)) {
    const auto information = models.information(id);
    addToFront(columns_, information.H, spans_);
    addRightHandSide(clique, information.g_c.data());
    columns_[clique.size][clique.size] += information.c();
    return;
  }
  std::ranges::sort(spans_, {}, &RowSpan::to);
  spans_.push_back({from, clique.size, 1});
  const auto term = models.term(id);
  if (addSquareToFront(columns_, term.data(), static_cast<int>(term.rows()), spans_)) return;
  std::ranges::sort(spans_, {}, &RowSpan::from);
  const int columns = static_cast<int>(term.cols()), stride = padded(columns);
  product_.assign(columns * stride, 0.0);
  addJacobianProduct(term.data(), static_cast<int>(term.rows()), columns, product_.data(), stride);
  addToFront(columns_, product_.data(), stride, spans_);
}

void Front::addChild(const Clique& clique, const Clique& child) {
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
  addToFront(columns_, child.updateMatrix(), spans_);
  addRightHandSide(clique, child.contribution);  // which holds it when it changed alone
}

/// Adds g at the scalars in `spans_`.
void Front::addRightHandSide(const Clique& clique, const double* g) {
  for (const RowSpan& span : spans_)
    for (int i = 0; i < span.size; ++i) columns_[span.to + i][clique.size] += g[span.from + i];
}

/// Splits spans at the border between panel and update matrix, which no span may cross.
void Front::splitAtFrontals(int frontal_size) {
  for (std::size_t i = 0; i < spans_.size(); ++i) {
    RowSpan& span = spans_[i];
    const int inside = frontal_size - span.to;
    if (inside <= 0 || inside >= span.size) continue;
    const RowSpan rest{span.from + inside, span.to + inside, span.size - inside};
    span.size = inside;
    spans_.insert(spans_.begin() + i + 1, rest);
    return;
  }
}

void Front::packUpdateMatrix(Clique& clique) const {
  packLowerTriangle(update_matrix_.data(), update_stride_, clique.separatorSize(), clique.update_matrix);
}

void Front::packContribution(Clique& clique) const {
  const int rest = clique.separatorSize();
  for (int j = 0; j < rest; ++j) clique.contribution[j] = update_matrix_[rest + std::size_t(j) * update_stride_];
}

/// Keeps the x of a scalar without information where the estimate stands.
void Front::holdSingular(Clique& clique, int column) {
  std::size_t v = 0;
  int component = column;
  while (component >= graph_.sizeOf(clique.variables[v])) component -= graph_.sizeOf(clique.variables[v++]);
  const double x = graph_.states()[clique.variables[v]].x[component];
  clique.panel[column * clique.panelStride() + clique.size] = -x;
}

Eigen::MatrixXd Front::schurComplement() const {
  return Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>(update_matrix_.data(), update_size_, update_size_,
                                                                    Eigen::OuterStride<>(update_stride_));
}

}  // namespace motorcade
