#include "backend/graph/factor_graph.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace motorcade {
namespace {

/// A vector's step is taken to put its factors off like that of a pose which turns so far.
constexpr double kVectorTurn_rad = 0.25;

/// Of the residuals: without noise the tolerances that are relative to it do not vanish.
constexpr double kLeastMeanSquare = 1e-8;

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

SmallVector step(const FactorGraph::Variable& variable) {
  SmallVector d(variable.size);
  for (int i = 0; i < variable.size; ++i) d[i] = variable.x[i] - variable.x_applied[i];
  return d;
}

}  // namespace

VariableId FactorGraph::addVariable(const Value& initial) {
  const VariableId id = takeSlot(free_variables_, variables_);
  Variable& variable = (*this)[id];
  variable.applied_estimate = variable.linearization_point = initial;
  variable.x = variable.x_spread = variable.x_compared = variable.x_linearized = variable.x_applied =
      variable.information = {};
  variable.size = dimension(initial);
  variable.alive = true;
  return id;
}

void FactorGraph::removeVariable(VariableId id) {
  assert((*this)[id].alive && (*this)[id].factors.empty());
  (*this)[id].alive = false;
  free_variables_.push_back(id);
}

Value FactorGraph::estimate(VariableId id) const {
  const Variable& variable = (*this)[id];
  if (variable.x == variable.x_applied) return variable.applied_estimate;
  return displaced(variable.applied_estimate, step(variable));
}

void FactorGraph::apply(VariableId id) {
  Variable& variable = (*this)[id];
  if (variable.x == variable.x_applied) return;
  variable.applied_estimate = displaced(variable.applied_estimate, step(variable));
  variable.x_applied = variable.x;
}

void FactorGraph::apply(const Factor& factor) {
  for (const VariableId v : factor.variables()) apply(v);
}

void FactorGraph::restartCoordinates() {
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    Variable& variable = variables_[i];
    if (!variable.alive) continue;
    apply({static_cast<std::int64_t>(i)});
    variable.x = variable.x_spread = variable.x_compared = variable.x_linearized = variable.x_applied = {};
    variable.linearization_point = variable.applied_estimate;
  }
}

void FactorGraph::moveLinearizationPoint(VariableId id) {
  apply(id);
  Variable& variable = (*this)[id];
  variable.linearization_point = variable.applied_estimate;
  variable.x_linearized = variable.x;
}

/// The turn between two coordinates of a variable; zero for vectors.
double FactorGraph::turnBetween(const Variable& variable, const Coordinates& from, const Coordinates& to) {
  if (std::holds_alternative<SmallVector>(variable.applied_estimate)) return 0;
  double squared = 0;
  for (int i = variable.size == 3 ? 2 : 3; i < variable.size; ++i) squared += (to[i] - from[i]) * (to[i] - from[i]);
  return std::sqrt(squared);
}

double FactorGraph::turnSinceLinearization(VariableId id) const {
  return turnBetween((*this)[id], (*this)[id].x_linearized, (*this)[id].x);
}

double FactorGraph::mismatchBound(VariableId id) const {
  const Variable& variable = (*this)[id];
  double sigmas_squared = 0;
  for (int i = 0; i < variable.size; ++i) {
    const double step = variable.x[i] - variable.x_compared[i];
    sigmas_squared += step * step * variable.information[i];
  }
  const double turn = isVector(id) ? kVectorTurn_rad : turnBetween(variable, variable.x_compared, variable.x);
  return turn * std::sqrt(sigmas_squared);
}

std::span<const Value* const> FactorGraph::valuesOf(const Factor& factor, Value Variable::*member) {
  values_.clear();
  for (const VariableId v : factor.variables()) values_.push_back(&((*this)[v].*member));
  return values_;
}

void FactorGraph::giveBack(LinearizedFactor& slot) {
  terms_.give(slot.term);
  terms_.give(slot.g_c);
  slot.term = slot.g_c = nullptr;
  slot.lower_H = nullptr;
}

std::optional<FactorId> FactorGraph::addFactor(AnyFactor factor) {
  LinearizedFactor fresh;
  if (auto* jacobian = std::get_if<std::unique_ptr<const JacobianFactor>>(&factor))
    fresh.jacobian = std::move(*jacobian);
  else
    fresh.quadratic = std::move(std::get<std::unique_ptr<const InformationFactor>>(factor));
  fresh.columns = 1;
  for (const VariableId v : fresh.factor().variables()) fresh.columns += sizeOf(v);
  if (!linearize(fresh)) return std::nullopt;
  const FactorId id = takeSlot(free_factors_, factors_);
  LinearizedFactor& slot = factors_[id.value];
  slot = std::move(fresh);
  variables_of_.resize(factors_.size());
  variables_of_[id.value] = slot.factor().variables();
  int at = 0;
  for (const VariableId v : slot.factor().variables()) {
    Variable& variable = (*this)[v];
    variable.factors.push_back(id);
    for (int i = 0; i < variable.size; ++i, ++at)
      variable.information[i] += slot.jacobian ? term(id).col(at).squaredNorm() : information(id).H.column(at)[at];
  }
  if (slot.jacobian) ++residual_count_;
  return id;
}

void FactorGraph::removeFactor(FactorId id) {
  auto& slot = factors_[id.value];
  assert(slot.used());
  for (const VariableId v : slot.factor().variables()) std::erase((*this)[v].factors, id);
  setCost(slot, 0);
  if (slot.jacobian) --residual_count_;
  giveBack(slot);
  slot.jacobian = nullptr;
  slot.quadratic = nullptr;
  variables_of_[id.value] = {};
  free_factors_.push_back(id);
}

void FactorGraph::setCost(LinearizedFactor& slot, double cost) {
  if (!std::isfinite(cost)) return;  // it would never leave the sum again
  total_cost_ += cost - slot.cost;
  if (slot.jacobian) residual_cost_ += cost - slot.cost;
  slot.cost = cost;
}

double FactorGraph::rmsResidual() const {
  const double mean_square = residual_count_ == 0 ? 0 : residual_cost_ / static_cast<double>(residual_count_);
  return std::sqrt(std::max(mean_square, kLeastMeanSquare));
}

bool FactorGraph::contains(VariableId id) const {
  return id.value >= 0 && static_cast<std::size_t>(id.value) < variables_.size() && (*this)[id].alive;
}

bool FactorGraph::contains(FactorId id) const {
  return id.value >= 0 && static_cast<std::size_t>(id.value) < factors_.size() && slot(id).used();
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
    if (factors_[i].used()) ids.push_back({static_cast<std::int64_t>(i)});
  return ids;
}

}  // namespace motorcade
