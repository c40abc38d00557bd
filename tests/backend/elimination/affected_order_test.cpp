#include "backend/elimination/affected_order.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backend/elimination/eliminator.hpp"
#include "tests/backend/random_factors.hpp"

namespace motorcade {
namespace {

using test::RandomWorld;
using testing::UnorderedElementsAreArray;

/// A long chain with a few short cuts, and the part that an update would eliminate anew.
struct ChainWithShortcuts {
  ChainWithShortcuts(std::uint64_t seed, std::size_t count) : world(seed, RandomWorld::Kind::kPlane) {
    for (std::size_t i = 0; i < count; ++i) {
      variables.push_back(world.addVariable(graph));
      graph.addFactor(world.prior(variables.back()));
      if (i > 0) graph.addFactor(world.between(variables[i - 1], variables[i], true));
      if (i > 6 && i % 9 == 0) graph.addFactor(world.between(variables[i - 2 - world.below(5)], variables[i], true));
    }
    removed.variables = variables;
    removed.factors = graph.factors();
  }

  /// Eliminates everything, and takes the top out again, from these variables' cliques on.
  void keepTopAbove(std::span<const VariableId> touched) {
    std::vector<int> cliques;
    const auto order = affected_order(removed.variables, removed.factors, {}, {});
    eliminator.eliminate({.order = order, .factors = removed.factors});
    for (const VariableId v : touched) cliques.push_back(tree.cliqueOf(v));
    removed = eliminator.remove(tree.withAncestors(cliques));
  }

  std::vector<VariableId> order(std::span<const VariableId> touched) {
    const auto order = affected_order(removed.variables, removed.factors, removed.orphans, touched);
    return {order.begin(), order.end()};
  }

  std::vector<VariableId> draw(std::size_t count) {
    std::set<VariableId> drawn;
    while (drawn.size() < count) drawn.insert(variables[world.below(variables.size())]);
    return {drawn.begin(), drawn.end()};
  }

  RandomWorld world;
  FactorGraph graph;
  EliminationTree tree;
  Eliminator eliminator{graph, tree};
  AffectedOrder affected_order{graph, tree};
  EliminationTree::Removed removed;
  std::vector<VariableId> variables;
};

/// Number of factors between each variable and the nearest touched one, by relaxation until nothing changes.
std::vector<int> distances(const ChainWithShortcuts& scene, std::span<const VariableId> touched) {
  constexpr int kFar = 1 << 20;
  std::vector<int> distance(scene.graph.slots(), kFar);
  for (const VariableId v : touched) distance[v.value] = 0;
  bool changed = true;
  const auto shorten = [&](VariableId from, VariableId to) {
    if (distance[from.value] + 1 >= distance[to.value]) return;
    distance[to.value] = distance[from.value] + 1;
    changed = true;
  };
  while (std::exchange(changed, false)) {
    for (const FactorId f : scene.graph.factors())
      for (const VariableId u : scene.graph.variablesOf(f))
        for (const VariableId v : scene.graph.variablesOf(f)) shorten(u, v);
  }
  return distance;
}

/// Band of a distance: bands end at distances 0, 1, 3, 7 and 15; all beyond is one.
int bandOf(int distance) {
  int band = 0;
  for (const int last : {0, 1, 3, 7, 15}) band += distance > last;
  return band;
}

void expectNearerIsLater(const ChainWithShortcuts& scene, std::span<const VariableId> order,
                         std::span<const VariableId> touched) {
  EXPECT_THAT(order, UnorderedElementsAreArray(scene.removed.variables));
  const auto distance = distances(scene, touched);
  for (std::size_t i = 1; i < order.size(); ++i)
    EXPECT_GE(bandOf(distance[order[i - 1].value]), bandOf(distance[order[i].value])) << "position " << i;
}

TEST(AffectedOrder, TheNearerToWhatWasTouchedTheLater) {
  std::set<int> bands;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ChainWithShortcuts scene(seed, 80);
    const auto touched = scene.draw(1 + seed % 3);
    expectNearerIsLater(scene, scene.order(touched), touched);
    for (const int distance : distances(scene, touched)) bands.insert(bandOf(distance));
  }
  EXPECT_EQ(bands.size(), 6U) << "some band was never tried";
}

TEST(AffectedOrder, DistancesGoThroughTheWholeGraph) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ChainWithShortcuts scene(seed, 80);
    const auto touched = scene.draw(8);
    scene.keepTopAbove(touched);
    ASSERT_GT(scene.removed.variables.size(), 6U);  // fewer cannot be told apart in six bands
    expectNearerIsLater(scene, scene.order(touched), touched);
  }
}

/// An offset that all measurements share does not bring them nearer to each other.
TEST(AffectedOrder, DistancesDoNotGoThroughWhatVeryManyFactorsShare) {
  ChainWithShortcuts scene(3, 200);
  const std::vector touched{scene.variables.back()};
  auto distance = distances(scene, touched);
  const VariableId shared = scene.world.addVariable(scene.graph);
  for (const VariableId v : scene.variables) scene.graph.addFactor(scene.world.between(shared, v, true));
  distance.resize(scene.graph.slots(), 0);
  scene.removed.variables.push_back(shared);
  scene.removed.factors = scene.graph.factors();
  const auto order = scene.order(std::vector{touched.front(), shared});
  for (std::size_t i = 1; i < order.size(); ++i)
    EXPECT_GE(bandOf(distance[order[i - 1].value]), bandOf(distance[order[i].value])) << "position " << i;
}

TEST(AffectedOrder, TheNewestComeLastAndWhatManyFactorsShare) {
  ChainWithShortcuts scene(4, 60);
  const VariableId shared = scene.world.addVariable(scene.graph);
  for (const VariableId v : scene.variables) scene.graph.addFactor(scene.world.between(shared, v, true));
  scene.removed.variables.push_back(shared);
  scene.removed.factors = scene.graph.factors();
  const auto v = [&](std::size_t i) { return scene.variables[i]; };
  const std::vector touched{v(20), v(21), v(40), v(59), shared}, newest{v(21), v(59)};
  const auto order = scene.affected_order(scene.removed.variables, scene.removed.factors, {}, touched, newest);
  EXPECT_THAT(order.last(3), testing::UnorderedElementsAre(v(21), v(59), shared));
  EXPECT_THAT(order.last(5).first(2), testing::UnorderedElementsAre(v(20), v(40)));
}

TEST(AffectedOrder, DoesNotDependOnCallsBefore) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    ChainWithShortcuts used(seed, 40), fresh(seed, 40);
    const auto touched = used.draw(2), same = fresh.draw(2);
    ASSERT_EQ(touched, same);
    used.order(std::vector{used.variables[3]});
    used.affected_order(std::span(used.variables).first(5), {}, {}, touched);
    EXPECT_EQ(used.order(touched), fresh.order(touched)) << "seed " << seed;
  }
}

/// The graph of the terms over the variables at hand.
class TermGraph {
 public:
  explicit TermGraph(const ChainWithShortcuts& scene) : neighbors_(scene.graph.slots()) {
    for (const FactorId f : scene.removed.factors) join(scene.graph.variablesOf(f));
    for (const int orphan : scene.removed.orphans) join(scene.tree[orphan].separator());
  }
  std::size_t degree(VariableId v) const { return neighbors_[v.value].size(); }
  void eliminate(VariableId v) {
    join(neighbors_[v.value]);
    for (const VariableId u : neighbors_[v.value]) neighbors_[u.value].erase(v);
  }

 private:
  template <class Variables>
  void join(const Variables& variables) {
    for (const VariableId u : variables)
      for (const VariableId v : variables)
        if (u != v) neighbors_[u.value].insert(v);
  }
  std::vector<std::set<VariableId>> neighbors_;
};

/// Blocks of R beyond the diagonal.
std::size_t blocksOfFactor(const ChainWithShortcuts& scene, std::span<const VariableId> order) {
  TermGraph graph(scene);
  std::size_t blocks = 0;
  for (const VariableId v : order) {
    blocks += graph.degree(v);
    graph.eliminate(v);
  }
  return blocks;
}

std::vector<VariableId> minimumDegreeOrder(const ChainWithShortcuts& scene) {
  TermGraph graph(scene);
  std::vector<VariableId> left = scene.removed.variables, order;
  while (!left.empty()) {
    const auto least = std::ranges::min_element(left, {}, [&](VariableId v) { return graph.degree(v); });
    graph.eliminate(*least);
    order.push_back(*least);
    left.erase(least);
  }
  return order;
}

TEST(AffectedOrder, WithinABandThereIsLittleFill) {
  std::size_t blocks = 0, least = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    ChainWithShortcuts scene(seed, 120);
    if (seed % 4 != 0) scene.keepTopAbove(scene.draw(20));
    blocks += blocksOfFactor(scene, scene.order({}));
    least += blocksOfFactor(scene, minimumDegreeOrder(scene));
  }
  // The exact degrees of the reference do better than approximate ones, if by little.
  EXPECT_LT(static_cast<double>(blocks), 1.05 * static_cast<double>(least));
}

}  // namespace
}  // namespace motorcade
