#include "backend/factor_graph.hpp"

#include <cassert>

namespace motorcade {
namespace {

/// A slot of `slots` that is free, or a new one at the end.
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

}  // namespace

VariableId FactorGraph::addVariable(const Value& initial) {
  const VariableId id = takeSlot(free_variables_, variables_);
  (*this)[id] = {.linearization_point = initial, .delta = SmallVector::Zero(dimension(initial)), .factors = {}, .alive = true};
  return id;
}

void FactorGraph::removeVariable(VariableId id) {
  assert((*this)[id].alive && (*this)[id].factors.empty());
  (*this)[id].alive = false;
  free_variables_.push_back(id);
}

LinearTerm FactorGraph::linearized(const Factor& factor) const {
  std::vector<const Value*> values;
  values.reserve(factor.variables().size());
  for (const VariableId v : factor.variables()) values.push_back(&(*this)[v].linearization_point);
  int columns = 1;
  for (const VariableId v : factor.variables()) columns += sizeOf(v);
  LinearTerm term{.form = factor.form(), .matrix = Eigen::MatrixXd(factor.rows(), columns)};
  factor.linearize(values, term.matrix);
  return term;
}

std::optional<FactorId> FactorGraph::addFactor(std::unique_ptr<const Factor> factor) {
  LinearTerm term = linearized(*factor);
  if (!term.matrix.allFinite()) return std::nullopt;
  const FactorId id = takeSlot(free_factors_, factors_);
  for (const VariableId v : factor->variables()) (*this)[v].factors.push_back(id);
  factors_[static_cast<std::size_t>(id.value)] = {std::move(factor), std::move(term)};
  return id;
}

void FactorGraph::removeFactor(FactorId id) {
  auto& slot = factors_[static_cast<std::size_t>(id.value)];
  assert(slot.factor);
  for (const VariableId v : slot.factor->variables()) std::erase((*this)[v].factors, id);
  slot = {};
  free_factors_.push_back(id);
}

void FactorGraph::moveToEstimate(VariableId id) {
  Variable& variable = (*this)[id];
  variable.linearization_point = retract(variable.linearization_point, variable.delta);
  variable.delta.setZero();
}

void FactorGraph::linearize(FactorId id) {
  auto& slot = factors_[static_cast<std::size_t>(id.value)];
  LinearTerm term = linearized(*slot.factor);
  if (term.matrix.allFinite()) slot.term = std::move(term);
}

std::vector<VariableId> FactorGraph::variables() const {
  std::vector<VariableId> ids;
  for (std::size_t i = 0; i < variables_.size(); ++i)
    if (variables_[i].alive) ids.push_back({static_cast<std::int64_t>(i)});
  return ids;
}

std::vector<FactorId> FactorGraph::factors() const {
  std::vector<FactorId> ids;
  for (std::size_t i = 0; i < factors_.size(); ++i)
    if (factors_[i].factor) ids.push_back({static_cast<std::int64_t>(i)});
  return ids;
}

}  // namespace motorcade
