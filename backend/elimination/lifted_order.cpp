#include "backend/elimination/lifted_order.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

namespace motorcade {
namespace {

constexpr int kBands = 5;  // at distances 1, 2 to 3, 4 to 7, 8 to 15; what is farther away comes first
constexpr int kFarthest = (1 << (kBands - 1)) - 1;
constexpr int kFirstLifted = kBands + 1, kBoundary = kBands + 2;  // other lifted ones are at distance 0

}  // namespace

std::span<const VariableId> LiftedOrder::operator()(const EliminationTree::Removed& part,
                                                    std::span<const VariableId> boundary,
                                                    std::span<const VariableId> lifted) {
  const auto own = static_cast<int>(part.variables.size());
  collectTerms(part, boundary);
  bandByDistance(lifted);
  group_[column_of_[lifted.front().value]] = kFirstLifted;
  std::fill(group_.begin() + own, group_.end(), kBoundary);
  for (int& group : group_) group = std::min(group, std::max(columns_ - 1, 0));  // as CCOLAMD wants them
  ordering_.begin(columns_);
  for (std::size_t t = 0; t + 1 < begin_.size(); ++t)
    ordering_.addRow(std::span(entries_).subspan(begin_[t], begin_[t + 1] - begin_[t]));
  order_.clear();
  for (const int column : ordering_.order(group_))
    if (column < own) order_.push_back(part.variables[column]);
  return order_;
}

/// The boundary is a term, as what is eliminated above the part couples it.
void LiftedOrder::collectTerms(const EliminationTree::Removed& part, std::span<const VariableId> boundary) {
  known_.reset(graph_.slots());
  column_of_.resize(graph_.slots());
  columns_ = 0;
  for (const auto& variables : {std::span<const VariableId>(part.variables), boundary})
    for (const VariableId v : variables) {
      known_.insert(v.value);
      column_of_[v.value] = columns_++;
    }
  entries_.clear();
  begin_.assign(1, 0);
  for (const FactorId f : part.factors) addTerm(graph_.factor(f).variables());
  for (const int orphan : part.orphans) addTerm(tree_[orphan].separator());
  addTerm(boundary);
}

void LiftedOrder::addTerm(std::span<const VariableId> variables) {
  for (const VariableId v : variables)
    if (known_.contains(v.value)) entries_.push_back(column_of_[v.value]);
  begin_.push_back(static_cast<int>(entries_.size()));
}

/// Breadth first from the lifted variables over the terms at hand: through what was eliminated below the part, too.
void LiftedOrder::bandByDistance(std::span<const VariableId> lifted) {
  terms_begin_.assign(columns_ + 1, 0);
  for (const int column : entries_) ++terms_begin_[column + 1];
  std::partial_sum(terms_begin_.begin(), terms_begin_.end(), terms_begin_.begin());
  terms_.resize(entries_.size());
  queue_.assign(terms_begin_.begin(), terms_begin_.end() - 1);  // where each column's next term goes
  for (std::size_t t = 0; t + 1 < begin_.size(); ++t)
    for (int e = begin_[t]; e < begin_[t + 1]; ++e) terms_[queue_[entries_[e]]++] = static_cast<int>(t);

  group_.assign(columns_, 0);
  distance_.assign(columns_, -1);
  passed_.reset(begin_.size());
  queue_.clear();
  const auto reach = [&](int column, int distance) {
    if (distance_[column] >= 0) return;
    distance_[column] = distance;
    group_[column] = kBands - static_cast<int>(std::bit_width(static_cast<unsigned>(distance)));
    queue_.push_back(column);
  };
  for (const VariableId v : lifted) reach(column_of_[v.value], 0);
  for (std::size_t i = 0; i < queue_.size() && distance_[queue_[i]] < kFarthest; ++i)
    for (int e = terms_begin_[queue_[i]]; e < terms_begin_[queue_[i] + 1]; ++e)
      if (const int t = terms_[e]; passed_.insert(t))
        for (int at = begin_[t]; at < begin_[t + 1]; ++at) reach(entries_[at], distance_[queue_[i]] + 1);
}

}  // namespace motorcade
