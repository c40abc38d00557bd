#include "backend/elimination/lifted_order.hpp"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "backend/smoother/factors.hpp"
#include "tests/backend/random_graphs.hpp"

namespace motorcade {
namespace {

/// A chain of poses, eliminated from the first to the last.
struct Chain {
  static constexpr int kPoses = 60;

  Chain() {
    for (int k = 0; k < kPoses; ++k) {
      x.push_back(graph.addVariable(SE3(Eigen::Matrix3d::Identity(), {1.0 * k, 0, 0})));
      const PoseNoise noise = test::isotropicNoise(0.1, 0.01);
      factors.push_back(
          k == 0 ? *graph.addFactor(std::make_unique<PriorFactor>(std::array{x[0]}, PriorModel{}, noise))
                 : *graph.addFactor(std::make_unique<MotionFactor>(
                       std::array{x[k - 1], x[k]}, MotionModel{SE3(Eigen::Matrix3d::Identity(), {1, 0, 0})}, noise)));
      graph.linearize(factors.back());
    }
    std::vector<int> created;
    tree.eliminate({.order = x, .boundary = {}, .factors = factors, .orphans = {}}, created);
  }

  /// The cliques from that of a variable up to the one below the clique of another.
  std::vector<int> cliquesBetween(VariableId from, VariableId to) const {
    std::vector<int> cliques;
    for (int c = tree.cliqueOf(from); c != tree.cliqueOf(to); c = tree[c].parent) cliques.push_back(c);
    return cliques;
  }

  /// Lifts x[0] above the others below `x[end]`.
  void lift(int end) {
    const auto cliques = cliquesBetween(x[0], x[end]);
    const int top = cliques.back(), parent = tree[top].parent;
    const std::vector<VariableId> boundary(tree[top].separator().begin(), tree[top].separator().end());
    EliminationTree::Removed part;
    tree.remove(cliques, part);
    LiftedOrder order(graph, tree);
    const auto ordered = order(part, boundary, std::array{x[0]});
    last.assign(ordered.end() - 3, ordered.end());
    std::vector<int> created;
    tree.eliminate({.order = ordered,
                    .boundary = boundary,
                    .factors = part.factors,
                    .orphans = part.orphans,
                    .parent = parent,
                    .numbering = Elimination::Numbering::kBetween},
                   created);
  }

  int cliquesAbove(VariableId v) const {
    int count = 0;
    for (int c = tree.cliqueOf(v); c >= 0; c = tree[c].parent) ++count;
    return count;
  }

  FactorGraph graph;
  std::vector<VariableId> x, last;
  std::vector<FactorId> factors;
  EliminationTree tree{graph};
};

TEST(LiftedOrder, BringsNeighborsAlong) {
  Chain chain;
  const int before = chain.cliquesAbove(chain.x[1]);
  chain.lift(40);
  EXPECT_EQ(chain.last.back(), chain.x[0]);
  EXPECT_EQ(chain.last[1], chain.x[1]);
  EXPECT_LT(chain.cliquesAbove(chain.x[0]), before / 2);
  EXPECT_LT(chain.cliquesAbove(chain.x[1]), before / 2);
}

TEST(LiftedOrder, ASecondLiftGoesOnAndTheOrderKeepsRoom) {
  Chain chain;
  chain.lift(20);
  for (int i = 0; i < 40; ++i) chain.lift(40);  // halving the room each time would end after thirty
  EXPECT_LT(chain.cliquesAbove(chain.x[0]), Chain::kPoses - 40 + 2);
  EXPECT_LT(chain.cliquesAbove(chain.x[1]), Chain::kPoses - 40 + 4);
  for (const int c : chain.tree.cliques())
    if (const int parent = chain.tree[c].parent; parent >= 0) {
      EXPECT_LT(chain.tree.sequence(c), chain.tree.sequence(parent));
    }
}

}  // namespace
}  // namespace motorcade
