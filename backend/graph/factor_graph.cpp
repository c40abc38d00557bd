#include "backend/graph/factor_graph.hpp"

#include <cassert>

namespace motorcade {
namespace {

/// Returns a free slot of `slots`, or a new one at the end.
template <class IdType, class Slot>
IdType takeSlot(std::vector<IdType>& free, std::vector<Slot>& slots) {
  if (free.empty()) {
    slots.emplace_back();
    return IdType{static_cast<std::int64_t>(slots.size()) - 1};
  }
  const IdType id = free.back();
  free.pop_back();
  return id;
}

template <class IdType, class Graph>
std::vector<IdType> idsIn(const Graph& graph, std::size_t slots) {
  std::vector<IdType> ids;
  for (IdType id{0}; id.value < static_cast<std::int64_t>(slots); ++id.value)
    if (graph.contains(id)) ids.push_back(id);
  return ids;
}

}  // namespace

VariableId FactorGraph::addVariable(const Value& initial) {
  const VariableId id = takeSlot(free_variables_, nodes_);
  nodes_[id.value].alive = true;
  states_.begin(id, initial);
  return id;
}

void FactorGraph::removeVariable(VariableId id) {
  assert(contains(id) && factorsOf(id).empty());
  nodes_[id.value].alive = false;
  free_variables_.push_back(id);
}

std::optional<FactorId> FactorGraph::addFactor(AnyFactor factor) {
  const FactorId id = takeSlot(free_factors_, variables_of_);
  if (!models_.add(id, std::move(factor))) {
    free_factors_.push_back(id);
    return std::nullopt;
  }
  variables_of_[id.value] = models_.factor(id).variables();
  for (const VariableId v : variablesOf(id)) nodes_[v.value].factors.push_back(id);
  return id;
}

void FactorGraph::removeFactor(FactorId id) {
  assert(contains(id));
  for (const VariableId v : variablesOf(id)) std::erase(nodes_[v.value].factors, id);
  variables_of_[id.value] = {};
  models_.remove(id);
  free_factors_.push_back(id);
}

std::vector<VariableId> FactorGraph::variables() const { return idsIn<VariableId>(*this, slots()); }

std::vector<FactorId> FactorGraph::factors() const { return idsIn<FactorId>(*this, factorSlots()); }

}  // namespace motorcade
