#include "backend/elimination/elimination_tree.hpp"

#include "tests/backend/eliminated_graph.hpp"

namespace motorcade {
namespace {

using test::EliminatedGraph;
using test::forRandomTrees;

TEST(EliminationTree, RemovedVariablesComeInTheirEliminationOrder) {
  forRandomTrees([](EliminatedGraph& scene) {
    std::vector<VariableId> expected = scene.variables;
    std::ranges::sort(expected, {}, [&](VariableId v) { return scene.tree.sequence(scene.tree.cliqueOf(v)); });
    const EliminationTree::Removed removed = scene.eliminator.remove(scene.cliques());
    EXPECT_TRUE(scene.tree.roots().empty());
    EXPECT_TRUE(removed.orphans.empty());
    ASSERT_EQ(removed.variables.size(), expected.size());
    EXPECT_EQ(test::matrixBytes(scene.tree), 0U);
    for (const VariableId v : scene.variables) EXPECT_EQ(scene.tree.cliqueOf(v), -1);
    scene.eliminator.eliminate({.order = removed.variables, .factors = removed.factors, .renumber = false});
    // Numbered as before: the same order results again.
    const auto& again = scene.eliminator.remove(scene.cliques());
    EXPECT_EQ(again.variables, removed.variables);
    scene.eliminator.eliminate({.order = again.variables, .factors = again.factors, .renumber = false});
  });
}

TEST(EliminationTree, FindsTheCliquesThatHoldAVariable) {
  forRandomTrees([](EliminatedGraph& scene) {
    for (const VariableId v : scene.variables) {
      std::vector<int> found, expected;
      scene.tree.appendCliquesWith(v, found);
      for (const int c : scene.cliques())
        if (std::ranges::count(scene.tree[c].variables, v) > 0) expected.push_back(c);
      EXPECT_THAT(found, testing::UnorderedElementsAreArray(expected));
    }
  });
}

}  // namespace
}  // namespace motorcade
