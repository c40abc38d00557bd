#include <gtest/gtest.h>

#include "backend/factors/twist_factors.hpp"
#include "backend/graph/factor_graph.hpp"
#include "tests/backend/random_factors.hpp"

namespace motorcade {
namespace {

using test::RandomWorld;

TEST(FactorGraph, TheBoundOfAMismatchGrowsWithTheTurnOfAPoseAndWithTheStepOfAVector) {
  RandomWorld world(5, RandomWorld::Kind::kSpace);
  FactorGraph graph;
  const VariableId pose = world.addVariable(graph), vector = graph.addVariable(SmallVector(SmallVector::Zero(3)));
  graph.addFactor(world.prior(pose));
  graph.addFactor(std::make_unique<VectorPriorFactor>(vector, SmallVector::Zero(3), SmallVector::Constant(3, 0.1)));
  EXPECT_EQ(graph.mismatchBound(pose), 0);
  graph[pose].x[0] += 1;  // a step without a turn leaves all models right
  EXPECT_EQ(graph.mismatchBound(pose), 0);
  graph[pose].x[3] += 0.01;
  const double turned = graph.mismatchBound(pose);
  EXPECT_GT(turned, 0);
  graph[pose].x[3] += 0.01;
  EXPECT_GT(graph.mismatchBound(pose), 1.9 * turned);
  EXPECT_EQ(graph.mismatchBound(vector), 0);
  graph[vector].x[1] += 0.02;
  EXPECT_NEAR(graph.mismatchBound(vector), 0.25 * 0.2, 1e-12);  // of its step in standard deviations
  graph.markCompared(vector);
  EXPECT_EQ(graph.mismatchBound(vector), 0);
}

}  // namespace
}  // namespace motorcade
