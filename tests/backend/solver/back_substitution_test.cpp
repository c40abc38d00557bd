#include "backend/solver/back_substitution.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/backend/random_factors.hpp"

namespace motorcade {
namespace {

constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();
constexpr double kSmallStep_sigmas = 1e-9;

/// Poses in a row, each measured against the one before it, eliminated from the first to the last.
struct PoseChain {
  static constexpr int kPoses = 8;

  PoseChain() {
    for (int i = 0; i < kPoses; ++i) poses.push_back(world.addVariable(graph));
    factors.push_back(*graph.addFactor(world.prior(poses[0])));
    for (int i = 1; i < kPoses; ++i) factors.push_back(*graph.addFactor(world.between(poses[i - 1], poses[i], true)));
    work.begin();
    work.markNew(eliminator.eliminate({.order = poses, .factors = factors}));
    substitution(kSmallStep_sigmas, kNoLimit);
  }
  void moveTheLast() {
    work.begin();
    const auto change = work.markShift(tree.cliqueOf(poses.back()));
    for (double& c : change) c += 1;
    work.apply(eliminator);
  }
  bool hasFollowed(FactorId f) const { return substitution.hasFollowed(f); }

  test::RandomWorld world{1, test::RandomWorld::Kind::kSpace};
  FactorGraph graph;
  std::vector<VariableId> poses;
  std::vector<FactorId> factors;
  EliminationTree tree;
  Eliminator eliminator{graph, tree};
  CliqueWork work{tree};
  EliminationBudget budget{{}};
  BackSubstitution substitution{graph, tree, work, budget};
};

TEST(BackSubstitution, TellsFactorsOfWhichAPartHasFollowedAStep) {
  PoseChain chain;
  for (const FactorId f : chain.factors) EXPECT_TRUE(chain.hasFollowed(f));
  chain.moveTheLast();
  chain.substitution(kSmallStep_sigmas, 0);
  EXPECT_GT(chain.substitution.waitingScalars(), 0);
  int half_followed = 0;
  for (const FactorId f : chain.factors) half_followed += chain.hasFollowed(f) ? 0 : 1;
  EXPECT_EQ(half_followed, 1) << "the one between the cliques that were solved and those that wait";
  chain.substitution(kSmallStep_sigmas, kNoLimit);
  EXPECT_EQ(chain.substitution.waitingScalars(), 0);
  for (const FactorId f : chain.factors) EXPECT_TRUE(chain.hasFollowed(f));
}

TEST(BackSubstitution, ComesOutTheSameWhateverACallMayDo) {
  PoseChain at_once, little_by_little;
  for (PoseChain* chain : {&at_once, &little_by_little}) chain->moveTheLast();
  at_once.substitution(kSmallStep_sigmas, kNoLimit);
  for (int calls = 0; calls < PoseChain::kPoses; ++calls) little_by_little.substitution(kSmallStep_sigmas, 6);
  for (const VariableId v : at_once.poses) EXPECT_EQ(at_once.graph.states()[v].x, little_by_little.graph.states()[v].x);
}

}  // namespace
}  // namespace motorcade
