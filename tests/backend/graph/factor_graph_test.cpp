#include "backend/graph/factor_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/backend/graph_scene.hpp"

namespace motorcade {
namespace {

using test::GraphScene;
using test::RandomWorld;

TEST(FactorGraph, KeepsBooksOfWhatComesAndGoes) {
  GraphScene scene(1, RandomWorld::Kind::kMixed);
  FactorGraph& graph = scene.graph;
  EXPECT_EQ(graph.variableCount(), 4U);
  EXPECT_EQ(graph.factorCount(), 10U);
  const VariableId gone = scene.variables[3];
  for (const FactorId f : std::vector(graph.factorsOf(gone))) {
    graph.removeFactor(f);
    EXPECT_FALSE(graph.contains(f));
    for (const VariableId v : scene.variables) EXPECT_THAT(graph.factorsOf(v), testing::Not(testing::Contains(f)));
  }
  graph.removeVariable(gone);
  EXPECT_FALSE(graph.contains(gone));
  EXPECT_THAT(graph.variables(), testing::ElementsAre(scene.variables[0], scene.variables[1], scene.variables[2]));
  EXPECT_EQ(graph.factors().size(), graph.factorCount());
  // The slot of one that left serves one that comes, without a trace of it.
  const VariableId next = graph.addVariable(SE3{});
  EXPECT_TRUE(graph.contains(next));
  EXPECT_EQ(graph.slots(), 4U);
  EXPECT_TRUE(graph.factorsOf(next).empty());
  EXPECT_EQ(graph.states()[next].information, VariableState::Coordinates{});
}

TEST(FactorGraph, RefusesAFactorThatIsNotFinite) {
  GraphScene scene(2, RandomWorld::Kind::kSpace);
  const std::size_t before = scene.graph.factorCount();
  const double cost = scene.models.totalCost();
  const SE3 broken(Eigen::Matrix3d::Identity(), {0, std::numeric_limits<double>::infinity(), 0});
  EXPECT_FALSE(scene.graph.addFactor(
      std::make_unique<PriorFactor>(std::array{scene.variables[0]}, PriorModel{broken}, PoseNoise{})));
  EXPECT_EQ(scene.graph.factorCount(), before);
  EXPECT_EQ(scene.models.totalCost(), cost);
}

}  // namespace
}  // namespace motorcade
