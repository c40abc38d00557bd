#include "backend/elimination/elimination_tree.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/backend/random_factors.hpp"
#include "tests/backend/tree_information.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::DenseSystem;
using test::IsNear;
using test::RandomWorld;

template <class T>
bool contains(std::span<const T> items, const T& item) {
  return std::ranges::find(items, item) != items.end();
}

/// A connected graph of up to twenty variables, eliminated in random order.
struct EliminatedGraph {
  EliminatedGraph(std::uint64_t seed, RandomWorld::Kind kind) : world(seed, kind) {
    const std::size_t count = 2 + world.below(19);
    for (std::size_t i = 0; i < count; ++i) addVariable();
    std::vector<VariableId> order = variables;
    shuffle(order);
    tree.eliminate({.order = order, .boundary = {}, .factors = graph.factors(), .orphans = {}}, created);
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

  /// The tree's square is what the factors state.
  void expectEqual() const {
    const DenseSystem dense(graph);
    const Eigen::MatrixXd expected = test::informationOfFactors(graph, dense);
    const double rounding = 1e-10 * expected.cwiseAbs().maxCoeff();  // of sums of some thousand products
    EXPECT_THAT(test::informationOfTree(tree, dense), IsNear(expected, rounding));
  }
  void expectSound() const;

  RandomWorld world;
  FactorGraph graph;
  EliminationTree tree{graph};
  std::vector<VariableId> variables;
  std::vector<int> created;
};

/// Each variable is frontal once, each factor belongs to the clique that owns it, each separator lies in the parent,
/// where the rows say.
void EliminatedGraph::expectSound() const {
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

TEST(EliminationTree, IsARootOfTheInformation) {
  forRandomTrees([](EliminatedGraph&) {});
}

TEST(EliminationTree, TheTopCanBeTakenOutAndEliminatedWithNewVariables) {
  forRandomTrees([](EliminatedGraph& scene) {
    std::vector<int> removed_cliques;
    for (int i = 0; i < 2; ++i)
      for (const int c :
           scene.pathFrom(scene.tree.cliqueOf(scene.variables[scene.world.below(scene.variables.size())])))
        removed_cliques.push_back(c);
    std::ranges::sort(removed_cliques);
    removed_cliques.erase(std::unique(removed_cliques.begin(), removed_cliques.end()), removed_cliques.end());
    EliminationTree::Removed removed;
    scene.tree.remove(removed_cliques, removed);
    // New ones hang on those that are out.
    const auto before = scene.graph.factors();
    for (int i = 0; i < 3; ++i) {
      const VariableId v = scene.world.addVariable(scene.graph);
      scene.graph.addFactor(scene.world.prior(v));
      scene.graph.addFactor(
          scene.world.between(removed.variables[scene.world.below(removed.variables.size())], v, true));
      removed.variables.push_back(v);
    }
    for (const FactorId f : scene.graph.factors())
      if (!std::ranges::binary_search(before, f)) removed.factors.push_back(f);
    scene.shuffle(removed.variables);
    scene.tree.eliminate(
        {.order = removed.variables, .boundary = {}, .factors = removed.factors, .orphans = removed.orphans},
        scene.created);
  });
}

TEST(EliminationTree, RemovedVariablesComeInTheirEliminationOrder) {
  forRandomTrees([](EliminatedGraph& scene) {
    std::vector<VariableId> expected = scene.variables;
    std::ranges::sort(expected, {}, [&](VariableId v) { return scene.tree.sequence(scene.tree.cliqueOf(v)); });
    EliminationTree::Removed removed;
    scene.tree.remove(scene.cliques(), removed);
    EXPECT_TRUE(scene.tree.roots().empty());
    EXPECT_TRUE(removed.orphans.empty());
    ASSERT_EQ(removed.variables.size(), expected.size());
    EXPECT_EQ(scene.tree.usedBytes(), 0U);
    for (const VariableId v : scene.variables) EXPECT_EQ(scene.tree.cliqueOf(v), -1);
    scene.tree.eliminate(
        {.order = removed.variables, .boundary = {}, .factors = removed.factors, .orphans = {}, .renumber = false},
        scene.created);
    // Numbered as before: the same order results again.
    EliminationTree::Removed again;
    scene.tree.remove(scene.cliques(), again);
    EXPECT_EQ(again.variables, removed.variables);
    scene.tree.eliminate(
        {.order = again.variables, .boundary = {}, .factors = again.factors, .orphans = {}, .renumber = false},
        scene.created);
  });
}

TEST(EliminationTree, APartInTheMiddleCanBeTakenOutAndHungBack) {
  forRandomTrees([](EliminatedGraph& scene) {
    const auto all = scene.cliques();
    const int middle = all[scene.world.below(all.size())];
    const int parent = scene.tree[middle].parent;
    const std::vector<VariableId> boundary(scene.tree[middle].separator().begin(),
                                           scene.tree[middle].separator().end());
    EliminationTree::Removed removed;
    scene.tree.remove(std::array{middle}, removed);
    std::vector<int> orphans;
    for (const int orphan : removed.orphans) {
      const auto separator = scene.tree[orphan].separator();
      const bool inside =
          std::ranges::any_of(separator, [&](VariableId v) { return contains<VariableId>(removed.variables, v); });
      if (inside)
        orphans.push_back(orphan);
      else
        scene.tree.attach(orphan, parent);
    }
    scene.tree.eliminate({.order = removed.variables,
                          .boundary = boundary,
                          .factors = removed.factors,
                          .orphans = orphans,
                          .parent = parent,
                          .renumber = false},
                         scene.created);
  });
}

TEST(EliminationTree, RefreshingAPathTakesUpNewLinearModels) {
  forRandomTrees([](EliminatedGraph& scene) {
    for (const VariableId v : scene.variables) {
      for (int i = 0; i < scene.graph.sizeOf(v); ++i) scene.graph.states()[v].x[i] += scene.world.noise().gaussian(0.1);
      scene.graph.states().apply(v);
    }
    const VariableId moved = scene.variables[scene.world.below(scene.variables.size())];
    scene.graph.states().moveLinearizationPoint(moved);
    std::vector<int> stale;
    for (const FactorId f : scene.graph.factorsOf(moved)) {
      scene.graph.models().linearize(f);
      for (const int c : scene.pathFrom(scene.ownerOf(f))) stale.push_back(c);
    }
    std::ranges::sort(stale);
    stale.erase(std::unique(stale.begin(), stale.end()), stale.end());
    std::ranges::sort(stale, {}, [&](int c) { return scene.tree.sequence(c); });
    const auto before = scene.tree.eliminatedScalars();
    std::int64_t frontal = 0;
    for (const int c : stale) {
      scene.tree.refresh(c);
      frontal += scene.tree[c].frontal_size;
    }
    EXPECT_EQ(scene.tree.eliminatedScalars() - before, frontal);
  });
}

/// Adds J^T r of a factor to the rows of a front.
void addGradient(const EliminatedGraph& scene, FactorId f, const Eigen::VectorXd& r, const Clique& clique,
                 std::vector<double>& change) {
  const auto term = scene.graph.models().term(f);
  const Eigen::VectorXd gradient = term.leftCols(term.cols() - 1).transpose() * r;
  Eigen::Index at = 0;
  for (const VariableId v : scene.graph.variablesOf(f)) {
    std::size_t row = 0;
    for (auto u = clique.variables.begin(); *u != v; ++u) row += static_cast<std::size_t>(scene.graph.sizeOf(*u));
    for (int i = 0; i < scene.graph.sizeOf(v); ++i) change[row++] += gradient[at++];
  }
}

TEST(EliminationTree, ShiftingTheRightHandSideTakesUpNewResiduals) {
  forRandomTrees([](EliminatedGraph& scene) {
    const auto factors = scene.graph.factors();
    for (int round = 0; round < 3; ++round) {
      const FactorId f = factors[scene.world.below(factors.size())];
      Eigen::VectorXd r(scene.graph.models().factor(f).rows());
      for (double& x : r) x = scene.world.noise().gaussian();
      const auto path = scene.pathFrom(scene.ownerOf(f));
      std::vector<double> change(static_cast<std::size_t>(scene.tree[path[0]].size), 0.0);
      addGradient(scene, f, r, scene.tree[path[0]], change);
      scene.graph.models().correctResidual(f, {.r = {r.data(), static_cast<std::size_t>(r.size())}});
      for (std::size_t i = 0; i < path.size(); ++i) {
        std::vector<double> above(i + 1 < path.size() ? static_cast<std::size_t>(scene.tree[path[i + 1]].size) : 0,
                                  0.0);
        scene.tree.shiftRightHandSide(path[i], change, above);
        change = above;
      }
    }
    scene.expectEqual();
    // What the shifted cliques pass on is kept: eliminating those above anew takes it up.
    auto all = scene.cliques();
    std::ranges::sort(all, {}, [&](int c) { return scene.tree.sequence(c); });
    for (std::size_t i = all.size() / 2; i < all.size(); ++i) scene.tree.refresh(all[i]);
  });
}

TEST(EliminationTree, FindsTheCliquesThatHoldAVariable) {
  forRandomTrees([](EliminatedGraph& scene) {
    for (const VariableId v : scene.variables) {
      std::vector<int> found, expected;
      scene.tree.appendCliquesWith(v, found);
      for (const int c : scene.cliques())
        if (contains<VariableId>(scene.tree[c].variables, v)) expected.push_back(c);
      EXPECT_THAT(found, testing::UnorderedElementsAreArray(expected));
    }
  });
}

TEST(EliminationTree, AMarginalIsTheSchurComplementOfItsFactors) {
  forRandomTrees([](EliminatedGraph& scene) {
    const VariableId gone = scene.variables[scene.world.below(scene.variables.size())];
    std::vector<VariableId> neighbors;
    for (const FactorId f : scene.graph.factorsOf(gone))
      for (const VariableId v : scene.graph.variablesOf(f))
        if (v != gone && !contains<VariableId>(neighbors, v)) neighbors.push_back(v);
    const Eigen::MatrixXd marginal = scene.tree.marginal(std::array{gone}, neighbors, scene.graph.factorsOf(gone));

    const DenseSystem dense(scene.graph);
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(dense.size() + 1, dense.size() + 1);
    for (const FactorId f : scene.graph.factorsOf(gone)) {
      auto at = dense.entries(scene.graph.variablesOf(f));
      at.push_back(dense.size());
      system(at, at) += scene.graph.models().term(f).transpose() * scene.graph.models().term(f);
    }
    const auto out = dense.entries(std::array{gone});
    auto stay = dense.entries(neighbors);
    stay.push_back(dense.size());
    const Eigen::MatrixXd expected =
        system(stay, stay) - system(stay, out) * test::solved(system(out, out), system(out, stay));
    const Eigen::MatrixXd lower = marginal.triangularView<Eigen::Lower>();
    EXPECT_THAT(lower,
                IsNear(Eigen::MatrixXd(expected.triangularView<Eigen::Lower>()), 1e-10 * system.cwiseAbs().maxCoeff()));
  });
}

TEST(EliminationTree, NamesTheScalarsThatNoFactorConstrains) {
  RandomWorld world(1, RandomWorld::Kind::kSpace);
  FactorGraph graph;
  EliminationTree tree(graph);
  const VariableId held = world.addVariable(graph), loose = world.addVariable(graph);
  graph.addFactor(world.prior(held));
  std::vector<int> created;
  tree.eliminate({.order = std::array{loose, held}, .boundary = {}, .factors = graph.factors(), .orphans = {}},
                 created);
  ASSERT_EQ(tree.singular().size(), 6U);
  for (const SingularScalar& scalar : tree.singular()) EXPECT_EQ(scalar.variable, loose);
  tree.clearFindings();
  EXPECT_TRUE(tree.singular().empty());
}

}  // namespace
}  // namespace motorcade
