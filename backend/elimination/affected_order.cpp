#include "backend/elimination/affected_order.hpp"

#include <algorithm>
#include <bit>

namespace motorcade {
namespace {

constexpr int kBands = 5;  // at distances 0, 1, 2 to 3, 4 to 7, 8 to 15; what is farther away comes first
constexpr int kFarthest = (1 << (kBands - 1)) - 1;
/// Number of factors beyond which a shared variable (an offset of all measurements) makes no two of them neighbors.
constexpr std::size_t kShared = 100;
/// Number of factors beyond which a variable couples what is eliminated after it, and so comes last, too.
constexpr std::size_t kCommon = 20;

constexpr std::size_t kAhead = 4;  // variables of a search that are asked for before they are looked at

}  // namespace

std::span<const VariableId> AffectedOrder::operator()(std::span<const VariableId> variables,
                                                      std::span<const FactorId> factors, std::span<const int> orphans,
                                                      std::span<const VariableId> touched,
                                                      std::span<const VariableId> newest) {
  variables_ = variables;
  column_of_.resize(graph_.slots(), 0);
  for (std::size_t i = 0; i < variables.size(); ++i) column_of_[variables[i].value] = static_cast<int>(i);
  bandByDistance(touched);
  putLast(touched, newest);
  ordering_.begin(static_cast<int>(variables.size()));
  for (const FactorId f : factors) addRow(graph_.variablesOf(f));
  for (const int orphan : orphans) addRow(tree_[orphan].separator());
  order_.clear();
  for (const int column : ordering_.order(group_)) order_.push_back(variables[column]);
  return order_;
}

/// Bands the variables by a breadth-first search from the touched ones, but not through what very many factors share.
/// The search ends when it has reached all variables at hand, or none for as many steps as before: the rest is far
/// away.
void AffectedOrder::bandByDistance(std::span<const VariableId> touched) {
  const int last = static_cast<int>(variables_.size()) - 1;
  const int last_group = std::max(last - 1, 0);  // CCOLAMD wants groups below the number of columns; one more follows
  group_.assign(variables_.size(), 0);
  reached_.reset(graph_.slots());
  passed_.reset(graph_.factorSlots());
  distance_.resize(graph_.slots());
  queue_.clear();
  std::size_t missing = variables_.size();
  int farthest = 0;  // of those at hand
  const auto reach = [&](VariableId v, int distance) {
    if (!reached_.insert(v.value)) return;
    distance_[v.value] = distance;
    queue_.push_back(v);
    const int column = column_of_[v.value];
    if (column > last || variables_[column] != v) return;
    group_[column] = std::min(kBands - static_cast<int>(std::bit_width(static_cast<unsigned>(distance))), last_group);
    --missing;
    farthest = distance;
  };
  for (const VariableId v : touched) reach(v, 0);
  for (std::size_t i = 0; i < queue_.size() && missing > 0; ++i) {
    const int distance = distance_[queue_[i].value];
    if (distance == kFarthest || distance > 2 * farthest + 1) break;
    if (i + kAhead < queue_.size()) __builtin_prefetch(&graph_.factorsOf(queue_[i + kAhead]));
    if (graph_.factorsOf(queue_[i]).size() > kShared) continue;
    for (const FactorId f : graph_.factorsOf(queue_[i]))
      if (passed_.insert(f.value))
        for (const VariableId neighbor : graph_.variablesOf(f)) reach(neighbor, distance + 1);
  }
}

void AffectedOrder::putLast(std::span<const VariableId> touched, std::span<const VariableId> newest) {
  const int columns = static_cast<int>(variables_.size()), group = std::min(kBands + 1, columns - 1);
  const auto isCommon = [&](VariableId v) { return graph_.factorsOf(v).size() > kCommon; };
  for (const VariableId v : newest) group_[column_of_[v.value]] = group;
  for (const VariableId v : touched)
    if (const int column = column_of_[v.value]; isCommon(v) && column < columns && variables_[column] == v)
      group_[column] = group;
}

void AffectedOrder::addRow(std::span<const VariableId> variables) {
  row_.clear();
  for (const VariableId v : variables) row_.push_back(column_of_[v.value]);
  ordering_.addRow(row_);
}

}  // namespace motorcade
