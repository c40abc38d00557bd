#include <algorithm>

#include <gtest/gtest.h>

#include "backend/solver/incremental_solver.hpp"
#include "tests/backend/dense_system.hpp"
#include "tests/backend/perturbation.hpp"
#include "tests/backend/random_factors.hpp"
#include "tests/backend/random_graphs.hpp"
#include "tests/backend/tree_information.hpp"

namespace motorcade {
namespace {

using test::differenceFromBatch;
using test::kExact;
using test::local;
using test::MultibodyGraph;
using test::RandomWorld;
using test::updateUntilStill;

constexpr std::size_t kWindow = 12;

/// Largest sizes over some frames.
struct Sizes {
  std::int64_t eliminated_scalars = 0;
  std::size_t used_bytes = 0, held_bytes = 0, variable_slots = 0, factor_slots = 0, cliques = 0, variables = 0,
              factors = 0;

  void include(const IncrementalSolver& solver, const IncrementalSolver::Report& report) {
    eliminated_scalars = std::max(eliminated_scalars, report.eliminated_scalars);
    used_bytes = std::max(used_bytes, test::matrixBytes(solver.tree()));
    held_bytes = std::max(held_bytes, solver.heldBytes());
    variable_slots = std::max(variable_slots, solver.graph().slots());
    factor_slots = std::max(factor_slots, solver.graph().factorSlots());
    cliques = std::max(cliques, solver.tree().slots());
    variables = std::max(variables, solver.graph().variableCount());
    factors = std::max(factors, solver.graph().factorCount());
  }
};

/// A car comes into view and leaves it every thirty frames.
void changeTraffic(IncrementalSolver& solver, MultibodyGraph& graph, int frame) {
  if (frame % 30 == 0) graph.startObject();
  if (frame % 30 == 20 && graph.objects().size() > 2) {
    const auto gone = graph.takeObject(0);
    if (frame % 60 == 20)
      solver.retire(gone);
    else
      solver.drop(gone);
  }
}

Sizes drive(IncrementalSolver& solver, MultibodyGraph& graph, int from, int to) {
  Sizes sizes;
  for (int i = from; i < to; ++i) {
    graph.addFrame();
    sizes.include(solver, solver.update());
    if (graph.camera().size() > kWindow) solver.retire(graph.takeOldest());
    changeTraffic(solver, graph, i);
  }
  return sizes;
}

TEST(Retirement, ADriveOfTwoThousandFramesCostsNoMoreThanItsWindowAndEndsAtTheBatchSolution) {
  IncrementalSolver solver({});
  MultibodyGraph graph(solver, 1, 1);
  drive(solver, graph, 1, 100);
  const Sizes early = drive(solver, graph, 100, 500), late = drive(solver, graph, 500, 2000);
  // Window, newest frame, and three objects with their anchors.
  const std::size_t most_variables = (kWindow + 1) * 4 + 3;
  EXPECT_LE(late.variables, most_variables);
  EXPECT_EQ(late.variable_slots, early.variable_slots);
  EXPECT_LE(late.factors, early.factors + early.factors / 4);
  EXPECT_LE(late.factor_slots, early.factor_slots + early.factor_slots / 4);
  EXPECT_LE(late.cliques, early.cliques + early.cliques / 4);
  EXPECT_LE(late.used_bytes, early.used_bytes + early.used_bytes / 4);
  EXPECT_LE(late.held_bytes, early.held_bytes + early.held_bytes / 4);
  EXPECT_LE(late.eliminated_scalars,
            2 * 6 * static_cast<std::int64_t>(most_variables));  // everything, in both iterations

  solver.converge(50, 1e-11);
  EXPECT_LT(differenceFromBatch(solver, 1e-3), 1e-7);  // at coordinates of some hundred meters
}

/// A variable's place in the tree, and its company when it leaves, make no difference to those that stay.
TEST(Retirement, AnyVariablesMayLeaveWithoutChangingTheOthers) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    IncrementalSolver solver(kExact);
    MultibodyGraph graph(solver, seed, 2);
    for (int i = 0; i < 10; ++i) {
      graph.addFrame();
      solver.update();
    }
    updateUntilStill(solver);
    auto variables = solver.graph().variables();
    std::vector<VariableId> leaving;
    for (std::size_t i = 0; i < 1 + seed; ++i) {
      const std::size_t k = graph.random().below(variables.size());
      leaving.push_back(variables[k]);
      variables.erase(variables.begin() + static_cast<std::ptrdiff_t>(k));
    }
    std::vector<Value> before;
    for (const VariableId v : variables) before.push_back(solver.estimate(v));
    const auto covariance = solver.jointCovariance(variables);
    solver.retire(leaving);
    updateUntilStill(solver);
    EXPECT_EQ(solver.graph().variables(), variables);
    EXPECT_EQ(solver.counters().retired_variables, static_cast<std::int64_t>(leaving.size()));
    for (std::size_t i = 0; i < variables.size(); ++i)
      EXPECT_LT(local(before[i], solver.estimate(variables[i])).norm(), 1e-8) << "seed " << seed;
    const auto after = solver.jointCovariance(variables);
    ASSERT_TRUE(covariance && after);
    EXPECT_LT((*after - *covariance).cwiseAbs().maxCoeff(), 1e-8 * covariance->cwiseAbs().maxCoeff())
        << "seed " << seed;
  }
}

/// Every object that goes leaves something on the offset of all measurements.
TEST(Retirement, WhatManyLeaveOnOneVariableStaysOneFactor) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    IncrementalSolver solver(kExact), same(kExact);
    RandomWorld world(seed, RandomWorld::Kind::kSpace), world_again(seed, RandomWorld::Kind::kSpace);
    const auto begin = [](IncrementalSolver& s, RandomWorld& w) {
      const VariableId shared = w.addVariable(s);
      s.addFactor(w.prior(shared));
      return shared;
    };
    const VariableId shared = begin(solver, world), shared_again = begin(same, world_again);
    for (int i = 0; i < 30; ++i) {
      const auto add = [](IncrementalSolver& s, RandomWorld& w, VariableId to) {
        const VariableId v = w.addVariable(s);
        s.addFactor(w.prior(v));
        s.addFactor(w.between(to, v, true));
        return v;
      };
      const VariableId v = add(solver, world, shared);
      add(same, world_again, shared_again);
      updateUntilStill(solver);
      solver.retire(std::vector{v});
    }
    updateUntilStill(solver);
    updateUntilStill(same);
    EXPECT_EQ(solver.graph().factorCount(), 2U);  // its own prior, and that of all others
    EXPECT_LT(local(same.estimate(shared_again), solver.estimate(shared)).norm(), 1e-3) << "seed " << seed;
    const auto covariance = solver.jointCovariance(std::vector{shared});
    const auto exact = same.jointCovariance(std::vector{shared_again});
    ASSERT_TRUE(covariance && exact);
    EXPECT_LT((*covariance - *exact).cwiseAbs().maxCoeff(), 0.01 * exact->cwiseAbs().maxCoeff()) << "seed " << seed;
  }
}

/// Ids are given out again at once: nothing noted about the variable that left may fall on the one that comes.
TEST(Retirement, NewOnesMayTakeTheIdsOfThoseThatLeft) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    IncrementalSolver solver({.relinearization = {.mismatch_tolerance = 1e-6,
                                                  .jacobian_drift_sigmas = 1e9,
                                                  .relinearize_rad = 1e9,
                                                  .leisurely_rad = 1e9},
                              .iterations_per_update = 1,
                              .budget = {}});
    MultibodyGraph graph(solver, seed, 2);
    for (int i = 0; i < 8; ++i) {
      graph.addFrame();
      solver.update();
    }
    solver.retire(graph.takeOldest());
    // More new variables than have left, on the factor ids that became free.
    graph.startObject();
    graph.addFrame();
    graph.addFrame();
    solver.update();
    solver.converge(50, 1e-11);
    EXPECT_LT(differenceFromBatch(solver, 1e-3), 1e-8) << "seed " << seed;
  }
}

}  // namespace
}  // namespace motorcade
