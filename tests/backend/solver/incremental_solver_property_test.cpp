#include <string>

#include <gtest/gtest.h>

#include "backend/solver/incremental_solver.hpp"
#include "tests/backend/dense_system.hpp"
#include "tests/backend/random_factors.hpp"
#include "tests/backend/random_graphs.hpp"

/// Edits a solver at random: whatever is added, removed, retired and dropped, in whatever order, once settled the
/// solver stands where a dense batch solution of its own graph stands.
namespace motorcade {
namespace {

using test::differenceFromBatch;
using test::kExact;
using test::MultibodyGraph;
using test::RandomWorld;
using test::updateUntilStill;

/// Tolerance in meters and radians. The systems have condition numbers of up to 1e7, which leaves 1e-9 of rounding.
constexpr double kBatchTol = 1e-8;

constexpr std::array kLosses{RobustLoss::kNone, RobustLoss::kHuber, RobustLoss::kCauchy, RobustLoss::kTukey};

/// Edits a solver's graph at random. A tree of relative measurements keeps every variable constrained; all others come
/// and go.
class RandomEdits {
 public:
  RandomEdits(IncrementalSolver& solver, std::uint64_t seed, RandomWorld::Kind kind, RobustLoss loss)
      : solver_(solver), world_(seed, kind, loss) {
    nodes_.push_back({world_.addVariable(solver_), {}});
    solver_.addFactor(world_.prior(nodes_[0].variable));
    solver_.update();
  }

  void edit() {
    const std::size_t choice = world_.below(20);
    if (choice < 10) {
      grow();
    } else if (choice < 14) {
      addExtra();
    } else if (choice < 16) {
      removeExtra();
    } else {
      solver_.update();
      if (choice < 19)
        retire();
      else
        drop();
      return;
    }
    if (world_.below(4) != 0) solver_.update();
  }

 private:
  struct Node {
    VariableId variable, parent;  // the one it is tied to
  };

  VariableId any() { return nodes_[world_.below(nodes_.size())].variable; }

  void grow() {
    // Mostly on a recent variable, sometimes far back.
    const std::size_t recent = std::min<std::size_t>(nodes_.size(), 3);
    const VariableId parent = world_.below(4) == 0 ? any() : nodes_[nodes_.size() - 1 - world_.below(recent)].variable;
    const VariableId v = world_.addVariable(solver_);
    solver_.addFactor(world_.between(parent, v, true));
    if (!world_.tiesFully(parent, v)) solver_.addFactor(world_.prior(v, 3));
    nodes_.push_back({v, parent});
    if (world_.below(2) == 0) addExtra();
  }

  void addExtra() {
    std::vector<VariableId> chosen{any(), any(), any()};
    if (chosen[0] == chosen[1] || chosen[1] == chosen[2] || chosen[0] == chosen[2]) return;
    const bool in_space = world_.isSpace(chosen[0]) && world_.isSpace(chosen[1]) && world_.isSpace(chosen[2]);
    const bool three = in_space && world_.below(2) == 0;
    const auto id = solver_.addFactor(three ? world_.encounter(chosen[0], chosen[1], chosen[2])
                                            : world_.between(chosen[0], chosen[1], false));
    ASSERT_TRUE(id);
    extras_.push_back(*id);
  }

  void removeExtra() {
    if (extras_.empty()) return;
    const std::size_t i = world_.below(extras_.size());
    solver_.removeFactor(extras_[i]);
    extras_.erase(extras_.begin() + static_cast<std::ptrdiff_t>(i));
  }

  /// Retires one to three variables at once, wherever they lie.
  void retire() {
    std::vector<VariableId> leaving;
    for (std::size_t i = 0; i < 1 + world_.below(3) && nodes_.size() > 3; ++i)
      leaving.push_back(forget(world_.below(nodes_.size())));
    solver_.retire(leaving);
  }

  /// Drops a variable that none is tied to.
  void drop() {
    std::vector<std::size_t> leaves;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (std::ranges::find(nodes_, nodes_[i].variable, &Node::parent) == nodes_.end()) leaves.push_back(i);
    if (nodes_.size() <= 3) return;
    solver_.drop(std::vector{forget(leaves[world_.below(leaves.size())])});
  }

  VariableId forget(std::size_t i) {
    const Node gone = nodes_[i];
    nodes_.erase(nodes_.begin() + static_cast<std::ptrdiff_t>(i));
    for (Node& node : nodes_)
      if (node.parent == gone.variable) node.parent = gone.parent;
    std::erase_if(extras_, [&](FactorId f) {
      const auto variables = solver_.graph().variablesOf(f);
      return std::ranges::find(variables, gone.variable) != variables.end();
    });
    return gone.variable;
  }

  IncrementalSolver& solver_;
  RandomWorld world_;
  std::vector<Node> nodes_;
  std::vector<FactorId> extras_;
};

void expectEditsToEndAtTheBatchSolution(RandomWorld::Kind kind) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    IncrementalSolver solver(kExact);
    RandomEdits edits(solver, seed, kind, kLosses[seed % 4]);
    for (std::size_t i = 0; i < 10 + 2 * seed; ++i) edits.edit();
    updateUntilStill(solver);
    EXPECT_LT(differenceFromBatch(solver), kBatchTol) << "seed " << seed;
  }
}

TEST(IncrementalSolverProperty, RandomEditsInSpaceEndAtTheBatchSolution) {
  expectEditsToEndAtTheBatchSolution(RandomWorld::Kind::kSpace);
}

TEST(IncrementalSolverProperty, RandomEditsInThePlaneEndAtTheBatchSolution) {
  expectEditsToEndAtTheBatchSolution(RandomWorld::Kind::kPlane);
}

TEST(IncrementalSolverProperty, RandomEditsOfMixedVariablesEndAtTheBatchSolution) {
  expectEditsToEndAtTheBatchSolution(RandomWorld::Kind::kMixed);
}

TEST(IncrementalSolverProperty, RandomEditsOfVectorsEndAtTheBatchSolution) {
  expectEditsToEndAtTheBatchSolution(RandomWorld::Kind::kVectors);
}

/// Encounters and smooth motion may go at any time: an object's motions and its other encounters hold it.
void removeSomeFactors(IncrementalSolver& solver, MultibodyGraph& graph) {
  for (const FactorId f : solver.graph().factors()) {
    const Factor& factor = solver.graph().models().factor(f);
    const auto* seen = dynamic_cast<const CameraEncounterFactor*>(&factor);
    const bool one_of_many = seen && solver.graph().factorsOf(factor.variables()[1]).size() > 6;  // of its anchor's
    if (!one_of_many && !dynamic_cast<const ObjectEncounterFactor*>(&factor) &&
        !dynamic_cast<const SmoothMotionFactor*>(&factor))
      continue;
    if (graph.random().below(5) == 0) solver.removeFactor(f);
  }
}

void playMultibodyDrive(IncrementalSolver& solver, std::uint64_t seed, RobustLoss loss) {
  MultibodyGraph graph(solver, seed, static_cast<int>(seed % 4), loss);
  RandomWorld dice(seed, RandomWorld::Kind::kSpace);
  const std::size_t frames = 4 + dice.below(22), window = 3 + dice.below(15);
  for (std::size_t i = 0; i < frames; ++i) {
    graph.addFrame();
    if (dice.below(4) == 0) removeSomeFactors(solver, graph);
    if (dice.below(5) != 0) solver.update();
    if (dice.below(6) == 0) graph.startObject();
    if (dice.below(8) == 0 && graph.camera().size() > window) {
      solver.update();
      // Several frames at once, as when the window shrinks.
      while (graph.camera().size() > window) solver.retire(graph.takeOldest());
    }
    if (dice.below(10) == 0 && !graph.objects().empty() && graph.objects()[0].anchor.valid()) {
      solver.update();
      const auto object = graph.takeObject(0);
      if (dice.below(2) == 0)
        solver.retire(object);
      else
        solver.drop(object);
    }
  }
}

TEST(IncrementalSolverProperty, RandomMultibodyDrivesEndAtTheBatchSolution) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    IncrementalSolver solver(kExact);
    playMultibodyDrive(solver, seed, kLosses[seed % 3]);
    updateUntilStill(solver);
    EXPECT_LT(differenceFromBatch(solver, 1e-3), kBatchTol) << "seed " << seed;
  }
}

TEST(IncrementalSolverProperty, ConvergingReachesTheBatchSolutionFromDefaultThresholds) {
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    IncrementalSolver solver({});
    RandomEdits edits(solver, seed, RandomWorld::kKinds[seed % 4], RobustLoss::kNone);
    for (int i = 0; i < 60; ++i) edits.edit();
    solver.update();
    solver.converge(50, 1e-11);
    EXPECT_LT(differenceFromBatch(solver), kBatchTol) << "seed " << seed;
  }
}

}  // namespace
}  // namespace motorcade
