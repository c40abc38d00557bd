#include "backend/graph/variable_states.hpp"

#include <gtest/gtest.h>

#include "backend/factors/twist_factors.hpp"
#include "tests/backend/factor_differences.hpp"
#include "tests/backend/graph_scene.hpp"
#include "tests/backend/perturbation.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::forAllKinds;
using test::GraphScene;
using test::IsNear;
using test::kResidualRounding;
using test::local;
using test::RandomWorld;
using test::residualAt;

TEST(VariableStates, RestartingTheCoordinatesKeepsTheEstimates) {
  forAllKinds([](GraphScene& scene) {
    scene.move(0.3);
    std::vector<Value> before;
    for (const VariableId v : scene.variables) before.push_back(scene.states.estimate(v));
    for (const VariableId v : scene.variables) scene.states.restartCoordinates(v);
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_LT(local(before[i], scene.states.estimate(scene.variables[i])).norm(), kResidualRounding);
      EXPECT_EQ(scene.states[scene.variables[i]].x, VariableState::Coordinates{});
    }
    for (const FactorId f : scene.factors) {
      scene.models.linearize(f);
      EXPECT_THAT(scene.modeled(f),
                  IsNear(residualAt(*scene.models.jacobianFactor(f), scene.estimatesOf(scene.models.factor(f))),
                         kResidualRounding));
    }
  });
}

TEST(VariableStates, TheTurnSinceLinearizationIsTheAngle) {
  GraphScene space(0, RandomWorld::Kind::kSpace), plane(0, RandomWorld::Kind::kPlane);
  for (auto* scene : {&space, &plane}) {
    const VariableId v = scene->variables[0];
    EXPECT_NEAR(scene->states.turnSinceLinearization(v), 0, 1e-7);
    const bool planar = scene == &plane;
    scene->states[v].x[planar ? 2 : 4] += 0.3;
    scene->states[v].x[0] += 5;
    scene->states.apply(v);
    EXPECT_NEAR(scene->states.turnSinceLinearization(v), 0.3, kResidualRounding);
    scene->states.moveLinearizationPoint(v);
    EXPECT_NEAR(scene->states.turnSinceLinearization(v), 0, 1e-7);
  }
}

TEST(VariableStates, StepsAreTakenBackToTheLinearizationPoint) {
  RandomWorld world(6, RandomWorld::Kind::kSpace);
  FactorGraph graph;
  VariableStates& states = graph.states();
  const VariableId v = world.addVariable(graph);
  const auto poseNow = [&] { return std::get<SE3>(states.estimate(v)); };
  states[v].x[0] += 1;
  states.moveLinearizationPoint(v);
  const SE3 linearized = poseNow();
  states[v].x[0] += 1, states[v].x[4] += 0.3;
  states.apply(v);
  EXPECT_GT((linearized.inverse() * poseNow()).log().norm(), 0.5);
  states.returnToLinearizationPoint(v);
  EXPECT_EQ((linearized.inverse() * poseNow()).log().norm(), 0);
  EXPECT_EQ(states.turnSinceLinearization(v), 0);
}

TEST(VariableStates, TheBoundOfAMismatchGrowsWithTheTurnOfAPoseAndWithTheStepOfAVector) {
  RandomWorld world(5, RandomWorld::Kind::kSpace);
  FactorGraph graph;
  VariableStates& states = graph.states();
  const VariableId pose = world.addVariable(graph), vector = graph.addVariable(SmallVector(SmallVector::Zero(3)));
  graph.addFactor(world.prior(pose));
  graph.addFactor(std::make_unique<VectorPriorFactor>(vector, SmallVector::Zero(3), SmallVector::Constant(3, 0.1)));
  EXPECT_EQ(states.mismatchBound(pose), 0);
  states[pose].x[0] += 1;  // a step without a turn leaves all models right
  EXPECT_EQ(states.mismatchBound(pose), 0);
  states[pose].x[3] += 0.01;
  const double turned = states.mismatchBound(pose);
  EXPECT_GT(turned, 0);
  states[pose].x[3] += 0.01;
  EXPECT_GT(states.mismatchBound(pose), 1.9 * turned);
  EXPECT_EQ(states.mismatchBound(vector), 0);
  states[vector].x[1] += 0.02;
  EXPECT_NEAR(states.mismatchBound(vector), 0.25 * 0.2, 1e-12);  // of its step in standard deviations
  states.markCompared(vector);
  EXPECT_EQ(states.mismatchBound(vector), 0);
}

}  // namespace
}  // namespace motorcade
