#include "backend/elimination/eliminator.hpp"

#include "tests/backend/eliminated_graph.hpp"

namespace motorcade {
namespace {

using test::DenseSystem;
using test::EliminatedGraph;
using test::forRandomTrees;
using test::IsNear;
using test::RandomWorld;

TEST(Eliminator, IsARootOfTheInformation) {
  forRandomTrees([](EliminatedGraph&) {});
}

TEST(Eliminator, TheTopCanBeTakenOutAndEliminatedWithNewVariables) {
  forRandomTrees([](EliminatedGraph& scene) {
    std::vector<int> removed_cliques;
    for (int i = 0; i < 2; ++i)
      for (const int c :
           scene.pathFrom(scene.tree.cliqueOf(scene.variables[scene.world.below(scene.variables.size())])))
        removed_cliques.push_back(c);
    std::ranges::sort(removed_cliques);
    removed_cliques.erase(std::unique(removed_cliques.begin(), removed_cliques.end()), removed_cliques.end());
    auto& removed = scene.eliminator.remove(removed_cliques);
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
    scene.eliminator.eliminate({.order = removed.variables, .factors = removed.factors, .orphans = removed.orphans});
  });
}

TEST(Eliminator, APartInTheMiddleCanBeTakenOutAndHungBack) {
  forRandomTrees([](EliminatedGraph& scene) {
    const auto all = scene.cliques();
    const int middle = all[scene.world.below(all.size())];
    const int parent = scene.tree[middle].parent;
    const std::vector<VariableId> boundary(scene.tree[middle].separator().begin(),
                                           scene.tree[middle].separator().end());
    const auto& removed = scene.eliminator.remove(std::array{middle});
    scene.eliminator.eliminate({.order = removed.variables,
                                .boundary = boundary,
                                .factors = removed.factors,
                                .orphans = removed.orphans,
                                .parent = parent,
                                .renumber = false});
  });
}

TEST(Eliminator, ALiftedVariableIsEliminatedLaterFromTheSameInformation) {
  int lifted = 0;
  forRandomTrees([&](EliminatedGraph& scene) {
    for (int i = 0; i < 4; ++i) {
      const VariableId v = scene.variables[scene.world.below(scene.variables.size())];
      auto path = scene.pathFrom(scene.tree.cliqueOf(v));
      path.resize(1 + scene.world.below(path.size()));
      const int top = path.back();
      if (!scene.eliminator.lift(v, path)) continue;
      ++lifted;
      EXPECT_EQ(scene.tree.cliqueOf(v), top);
      EXPECT_EQ(scene.tree[top].frontalVariables().back(), v);
      scene.expectSound();
      scene.expectEqual();
    }
  });
  EXPECT_GT(lifted, 100);
}

/// The cliques above gather what a lifted path passes on, and come out the same.
TEST(Eliminator, TheCliquesAboveCanBeEliminatedAfterALift) {
  forRandomTrees([](EliminatedGraph& scene) {
    for (int i = 0; i < 3; ++i) {
      const VariableId v = scene.variables[scene.world.below(scene.variables.size())];
      auto path = scene.pathFrom(scene.tree.cliqueOf(v));
      path.resize(1 + scene.world.below(path.size()));
      scene.eliminator.lift(v, path);
    }
    const auto all = scene.cliques();
    const auto path = scene.pathFrom(all[scene.world.below(all.size())]);
    for (const int c : path) scene.eliminator.refresh(c);
  });
}

TEST(Eliminator, RefreshingAPathTakesUpNewLinearModels) {
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
    const auto before = scene.eliminator.eliminatedScalars();
    std::int64_t frontal = 0;
    for (const int c : stale) {
      scene.eliminator.refresh(c);
      frontal += scene.tree[c].frontal_size;
    }
    EXPECT_EQ(scene.eliminator.eliminatedScalars() - before, frontal);
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

TEST(Eliminator, ShiftingTheRightHandSideTakesUpNewResiduals) {
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
        scene.eliminator.shiftRightHandSide(path[i], change, above);
        change = above;
      }
    }
    scene.expectEqual();
    // What the shifted cliques pass on is kept: eliminating those above anew takes it up.
    auto all = scene.cliques();
    std::ranges::sort(all, {}, [&](int c) { return scene.tree.sequence(c); });
    for (std::size_t i = all.size() / 2; i < all.size(); ++i) scene.eliminator.refresh(all[i]);
  });
}

TEST(Eliminator, AMarginalIsTheSchurComplementOfItsFactors) {
  forRandomTrees([](EliminatedGraph& scene) {
    const VariableId gone = scene.variables[scene.world.below(scene.variables.size())];
    std::vector<VariableId> neighbors;
    for (const FactorId f : scene.graph.factorsOf(gone))
      for (const VariableId v : scene.graph.variablesOf(f))
        if (v != gone && std::ranges::count(neighbors, v) == 0) neighbors.push_back(v);
    const Eigen::MatrixXd marginal =
        scene.eliminator.marginal(std::array{gone}, neighbors, scene.graph.factorsOf(gone));

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

TEST(Eliminator, TellsThatNoFactorConstrainsAScalar) {
  RandomWorld world(1, RandomWorld::Kind::kSpace);
  FactorGraph graph;
  EliminationTree tree;
  Eliminator eliminator(graph, tree);
  const VariableId held = world.addVariable(graph), loose = world.addVariable(graph);
  graph.addFactor(world.prior(held));
  eliminator.eliminate({.order = std::array{loose, held}, .factors = graph.factors()});
  EXPECT_EQ(eliminator.weakestPivot(), 0);
  EXPECT_EQ(tree[tree.cliqueOf(loose)].singular.size(), 6U);
  eliminator.resetWeakestPivot();
  EXPECT_EQ(eliminator.weakestPivot(), 1);
}

}  // namespace
}  // namespace motorcade
