#include "backend/graph/variable_states.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {
namespace {

using Coordinates = VariableState::Coordinates;

/// Turn of a pose that puts its factors off as far as a vector's step is taken to put its own.
constexpr double kVectorTurn_rad = 0.25;

/// Step since the estimate was applied.
SmallVector step(const VariableState& state) {
  SmallVector d(state.size);
  for (int i = 0; i < state.size; ++i) d[i] = state.x[i] - state.x_applied[i];
  return d;
}

/// The turn between two coordinates of a variable; zero for vectors.
double turnBetween(const VariableState& state, const Coordinates& from, const Coordinates& to) {
  if (state.is_vector) return 0;
  double squared = 0;
  for (int i = state.size == 3 ? 2 : 3; i < state.size; ++i) squared += (to[i] - from[i]) * (to[i] - from[i]);
  return std::sqrt(squared);
}

}  // namespace

void VariableStates::begin(VariableId id, const Value& initial) {
  states_.resize(std::max(states_.size(), static_cast<std::size_t>(id.value) + 1));
  (*this)[id] = {.size = dimension(initial),
                 .is_vector = std::holds_alternative<SmallVector>(initial),
                 .applied_estimate = initial,
                 .linearization_point = initial};
}

Value VariableStates::estimate(VariableId id) const {
  const VariableState& state = (*this)[id];
  if (state.x == state.x_applied) return state.applied_estimate;
  return displaced(state.applied_estimate, step(state));
}

void VariableStates::apply(VariableId id) {
  VariableState& state = (*this)[id];
  if (state.x == state.x_applied) return;
  state.applied_estimate = displaced(state.applied_estimate, step(state));
  state.x_applied = state.x;
}

void VariableStates::apply(std::span<const VariableId> ids) {
  for (const VariableId id : ids) apply(id);
}

void VariableStates::restartCoordinates(VariableId id) {
  moveLinearizationPoint(id);
  VariableState& state = (*this)[id];
  state.x = state.x_spread = state.x_compared = state.x_linearized = state.x_applied = {};
}

void VariableStates::moveLinearizationPoint(VariableId id) {
  apply(id);
  VariableState& state = (*this)[id];
  state.linearization_point = state.applied_estimate;
  state.x_linearized = state.x;
}

void VariableStates::returnToLinearizationPoint(VariableId id) {
  VariableState& state = (*this)[id];
  state.applied_estimate = state.linearization_point;
  state.x = state.x_applied = state.x_linearized;
}

double VariableStates::turnSinceLinearization(VariableId id) const {
  const VariableState& state = (*this)[id];
  return turnBetween(state, state.x_linearized, state.x);
}

double VariableStates::mismatchBound(VariableId id) const {
  const VariableState& state = (*this)[id];
  double sigmas_squared = 0;
  for (int i = 0; i < state.size; ++i) {
    const double step = state.x[i] - state.x_compared[i];
    sigmas_squared += step * step * state.information[i];
  }
  const double turn = isVector(id) ? kVectorTurn_rad : turnBetween(state, state.x_compared, state.x);
  return turn * std::sqrt(sigmas_squared);
}

}  // namespace motorcade
