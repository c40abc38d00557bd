#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backend/elimination/eliminator.hpp"
#include "tests/backend/random_factors.hpp"
#include "tests/backend/tree_information.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade::test {

/// A connected graph of up to twenty variables, eliminated in random order.
struct EliminatedGraph {
  EliminatedGraph(std::uint64_t seed, RandomWorld::Kind kind) : world(seed, kind) {
    const std::size_t count = 2 + world.below(19);
    for (std::size_t i = 0; i < count; ++i) addVariable();
    std::vector<VariableId> order = variables;
    shuffle(order);
    eliminator.eliminate({.order = order, .factors = graph.factors()});
  }

  void addVariable() {
    const VariableId v = world.addVariable(graph);
    graph.addFactor(world.prior(v, 10));
    for (std::size_t i = 0; i < 1 + world.below(2) && !variables.empty(); ++i) {
      const std::size_t back = 1 + world.below(std::min<std::size_t>(variables.size(), world.below(4) == 0 ? 20 : 3));
      graph.addFactor(world.between(variables[variables.size() - back], v, true));
    }
    variables.push_back(v);
  }

  template <class T>
  void shuffle(std::vector<T>& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[world.below(i)]);
  }

  std::vector<int> cliques() const {
    std::vector<int> all = tree.roots();
    for (std::size_t i = 0; i < all.size(); ++i)
      for (int child = tree[all[i]].first_child; child >= 0; child = tree[child].next_sibling) all.push_back(child);
    return all;
  }
  int ownerOf(FactorId f) const { return tree.ownerOf(graph.variablesOf(f)); }
  /// A clique and all above it, children first.
  std::vector<int> pathFrom(int clique) const {
    std::vector<int> path;
    for (; clique >= 0; clique = tree[clique].parent) path.push_back(clique);
    return path;
  }

  /// Expects the tree's square to equal what the factors state.
  void expectEqual() const {
    const DenseSystem dense(graph);
    const Eigen::MatrixXd expected = informationOfFactors(graph, dense);
    const double rounding = 1e-10 * expected.cwiseAbs().maxCoeff();  // of sums of some thousand products
    EXPECT_THAT(informationOfTree(tree, dense), IsNear(expected, rounding));
  }
  void expectSound() const;

  RandomWorld world;
  FactorGraph graph;
  EliminationTree tree;
  Eliminator eliminator{graph, tree};
  std::vector<VariableId> variables;
};

/// Expects each variable to be frontal once, each factor to belong to the clique that owns it, and each separator to
/// lie in the parent, where the rows say.
inline void EliminatedGraph::expectSound() const {
  std::vector<VariableId> frontals;
  std::vector<FactorId> factors;
  for (const int c : cliques()) {
    const Clique& clique = tree[c];
    for (const VariableId v : clique.frontalVariables()) {
      frontals.push_back(v);
      EXPECT_EQ(tree.cliqueOf(v), c);
    }
    for (const FactorId f : clique.factors) {
      factors.push_back(f);
      EXPECT_EQ(ownerOf(f), c);
      for (const VariableId v : graph.variablesOf(f)) EXPECT_THAT(clique.variables, testing::Contains(v));
    }
    if (clique.parent < 0) {
      EXPECT_EQ(clique.separatorSize(), 0);
      continue;
    }
    const Clique& parent = tree[clique.parent];
    EXPECT_LT(tree.sequence(c), tree.sequence(clique.parent));
    ASSERT_EQ(clique.row_in_parent.size(), clique.separator().size());
    for (std::size_t i = 0; i < clique.separator().size(); ++i) {
      int row = 0;
      for (auto v = parent.variables.begin(); v != parent.variables.end() && *v != clique.separator()[i]; ++v)
        row += graph.sizeOf(*v);
      EXPECT_EQ(clique.row_in_parent[i], row);
    }
  }
  std::ranges::sort(frontals);
  std::ranges::sort(factors);
  EXPECT_EQ(frontals, graph.variables());
  EXPECT_EQ(factors, graph.factors());
}

template <class Check>
void forRandomTrees(const Check& check) {
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    EliminatedGraph scene(seed, RandomWorld::kKinds[seed % 4]);
    check(scene);
    scene.expectSound();
    scene.expectEqual();
  }
}

}  // namespace motorcade::test
