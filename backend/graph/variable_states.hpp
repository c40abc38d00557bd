#pragma once

#include <array>
#include <span>
#include <vector>

#include "backend/graph/variable.hpp"

namespace motorcade {

/// State of a variable: its coordinates x in all linear models, and the values around which these are stated. What each
/// step reads lies in the first cache lines.
struct alignas(64) VariableState {
  static constexpr int kMaxDimension = 6;
  using Coordinates = std::array<double, kMaxDimension>;

  int size = 0;
  bool is_vector = false;  // not a pose
  Coordinates x{};         // the solution of the linear system
  Coordinates x_spread{};  // the one that the cliques below were solved with
  /// Diagonal of J^T J of its factors as they came: what a step means in standard deviations.
  Coordinates information{};
  Coordinates x_linearized{};  // at the linearization point
  Coordinates x_compared{};    // where its factors' models were last compared with the factors
  Coordinates x_applied{};     // at the applied estimate
  Value applied_estimate;      // moves up to x before it is used
  Value linearization_point;   // where the Jacobians of all its factors are taken
};

/// Estimates of the variables of a FactorGraph, and the coordinates that move them.
///
/// Where the solver moves x, the estimate follows by the same step in the world's axes: x adds up the steps of a
/// variable since it was added. So no origin has to move when something is relinearized, which touches only the factors
/// concerned. A model of which only the residual is off can be corrected by a new right-hand side.
class VariableStates {
 public:
  const VariableState& operator[](VariableId id) const { return states_[id.value]; }
  VariableState& operator[](VariableId id) { return states_[id.value]; }

  /// Begins a variable at x = 0. Ids come without gaps, or are those of variables that are gone.
  void begin(VariableId id, const Value& initial);
  Value estimate(VariableId id) const;
  bool isVector(VariableId id) const { return (*this)[id].is_vector; }
  /// Asks for the cache lines that a comparison of x reads first.
  void fetch(VariableId id) const {
    const auto* const state = reinterpret_cast<const char*>(&(*this)[id]);
    for (int line = 0; line < 4; ++line) __builtin_prefetch(state + line * 64);
  }

  /// Lets the estimate follow x.
  void apply(VariableId id);
  void apply(std::span<const VariableId> ids);
  /// Applies x, and restarts it at zero: all models of the variable must be linearized anew.
  void restartCoordinates(VariableId id);
  /// Moves the point at which the Jacobians of the variable's factors are taken to its estimate; linearize them after
  /// that.
  void moveLinearizationPoint(VariableId id);
  /// Takes back all steps since then.
  void returnToLinearizationPoint(VariableId id);
  /// Turn of the estimate since then [rad].
  double turnSinceLinearization(VariableId id) const;

  /// Bound, in standard deviations, of the errors that a variable's steps since the last comparison made in its
  /// factors' linear models. Such errors come from turning, and grow with turn times step. Factors of vectors are
  /// bilinear at most: for them a fixed share of the step is a guess.
  double mismatchBound(VariableId id) const;
  void markCompared(VariableId id) { (*this)[id].x_compared = (*this)[id].x; }

 private:
  std::vector<VariableState> states_;
};

}  // namespace motorcade
