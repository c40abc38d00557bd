#include "backend/elimination/update_matrices.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "backend/solver/incremental_solver.hpp"
#include "tests/backend/random_graphs.hpp"
#include "tests/backend/tree_information.hpp"

namespace motorcade {
namespace {

using test::MultibodyGraph;

constexpr int kMostInARow = 16;

/// A camera and two vehicles. Old poses are relinearized now and then, and beyond a window they retire.
struct Drive {
  static constexpr std::size_t kWindow = 80;

  explicit Drive(int kept_eliminations, std::size_t kept_bytes = 0)
      : solver({.relinearization = {.relinearize_rad = 1e-3, .leisurely_rad = 1e-4},
                .budget = {},
                .kept_eliminations = kept_eliminations,
                .kept_bytes = kept_bytes}),
        graph(solver, 5, 2) {}

  void addFrame() {
    graph.addFrame();
    const auto& report = solver.update();
    relinearized += report.relinearized_variables;
    if (graph.camera().size() > kWindow) solver.retire(graph.takeOldest());
  }

  IncrementalSolver solver;
  MultibodyGraph graph;
  int relinearized = 0;
};

/// Number of cliques without an update matrix in a tree, and the most of them above each other in a row.
struct Without {
  int cliques = 0, in_a_row = 0;

  explicit Without(const EliminationTree& tree) {
    for (const int c : tree.cliques()) {
      int row = 0;
      for (int above = c; above >= 0 && !tree[above].update_matrix; above = tree[above].parent) ++row;
      cliques += row > 0 ? 1 : 0;
      in_a_row = std::max(in_a_row, row);
    }
  }
};

TEST(UpdateMatrices, MadeAgainTheyAreWhatTheyWere) {
  Drive all(0), few(2);
  int cliques_without = 0;
  for (int frame = 0; frame < 200; ++frame) {
    all.addFrame(), few.addFrame();
    cliques_without = std::max(cliques_without, Without(few.solver.tree()).cliques);
    for (const VariableId v : all.solver.graph().variables()) {
      const auto &of_all = all.solver.graph().states()[v].x, &of_few = few.solver.graph().states()[v].x;
      for (std::size_t i = 0; i < of_all.size(); ++i) ASSERT_NEAR(of_all[i], of_few[i], 1e-9) << "frame " << frame;
    }
  }
  EXPECT_GT(cliques_without, 50);
  EXPECT_GT(few.relinearized, 5000) << "old cliques are eliminated anew where they stand";
  EXPECT_EQ(few.relinearized, all.relinearized);
}

TEST(UpdateMatrices, ThoseGivenBackTakeNoMemory) {
  Drive all(0), few(2);
  for (int frame = 0; frame < 100; ++frame) all.addFrame(), few.addFrame();
  EXPECT_LT(static_cast<double>(test::matrixBytes(few.solver.tree())),
            0.8 * static_cast<double>(test::matrixBytes(all.solver.tree())));
}

TEST(UpdateMatrices, SomeStaySoThatFewAreMadeAgainForOne) {
  Drive drive(2);
  int in_a_row = 0;
  for (int frame = 0; frame < 200; ++frame) {
    drive.addFrame();
    in_a_row = std::max(in_a_row, Without(drive.solver.tree()).in_a_row);
  }
  EXPECT_LE(in_a_row, kMostInARow);
  EXPECT_GT(in_a_row, 4);
}

TEST(UpdateMatrices, WithoutALimitAllAreKept) {
  Drive drive(0);
  for (int frame = 0; frame < 100; ++frame) drive.addFrame();
  EXPECT_EQ(Without(drive.solver.tree()).cliques, 0);
}

TEST(UpdateMatrices, AllAreKeptWhileTheyTakeLittleMemory) {
  Drive within(2, std::size_t{1} << 30), beyond(2, 1);
  for (int frame = 0; frame < 100; ++frame) within.addFrame(), beyond.addFrame();
  EXPECT_EQ(Without(within.solver.tree()).cliques, 0);
  EXPECT_GT(Without(beyond.solver.tree()).cliques, 0);
}

}  // namespace
}  // namespace motorcade
