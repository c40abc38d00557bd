#include "backend/solver/incremental_solver.hpp"

#include <gtest/gtest.h>

#include "tests/backend/dense_system.hpp"
#include "tests/backend/random_graphs.hpp"
#include "tests/backend/tree_information.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::DenseSystem;
using test::differenceFromBatch;
using test::IsNear;
using test::IsNearPose;
using test::kExact;
using test::MultibodyGraph;

TEST(IncrementalSolver, ConvergesToTheBatchSolutionOfRandomMultibodyGraphs) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    IncrementalSolver solver(kExact);
    MultibodyGraph graph(solver, seed, 1 + static_cast<int>(seed % 3));
    for (int i = 0; i < 12; ++i) {
      graph.addFrame();
      solver.update();
    }
    for (int i = 0; i < 10; ++i) solver.update();
    EXPECT_LT(differenceFromBatch(solver), 1e-8) << "seed " << seed;
  }
}

void removeSomeObjectEncounters(IncrementalSolver& solver, MultibodyGraph& graph) {
  for (const FactorId f : solver.graph().factors()) {
    if (solver.graph().variablesOf(f).size() != 4 || graph.random().below(3) != 0) continue;
    if (dynamic_cast<const ObjectEncounterFactor*>(&solver.graph().models().factor(f))) solver.removeFactor(f);
  }
}

TEST(IncrementalSolver, StaysEqualToBatchWhenFactorsAndVariablesComeAndGo) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    IncrementalSolver solver(kExact);
    MultibodyGraph graph(solver, seed, 2);
    for (int i = 0; i < 30; ++i) {
      graph.addFrame();
      // Object-object encounters may go at any time: nothing hangs on them alone.
      if (i % 5 == 4) removeSomeObjectEncounters(solver, graph);
      solver.update();
      if (i >= 8) solver.retire(graph.takeOldest());
    }
    for (int i = 0; i < 10; ++i) solver.update();
    EXPECT_EQ(solver.counters().variables, 8 + 2 * (8 + 1));
    EXPECT_LT(differenceFromBatch(solver), 1e-8) << "seed " << seed;
  }
}

TEST(IncrementalSolver, FoldingLeavesTheFactorOfTheWholeInformation) {
  for (const auto policy : {IncrementalSolver::Policy::kFluid, IncrementalSolver::Policy::kEveryN}) {
    IncrementalSolver::Params params = kExact;
    params.policy = policy;
    params.batch_every_updates = 1000;  // folding only
    params.relinearization.mismatch_tolerance = 1e9;
    IncrementalSolver solver(params);
    MultibodyGraph graph(solver, 3, 2);
    for (int i = 0; i < 10; ++i) {
      graph.addFrame();
      solver.update();
    }
    const DenseSystem dense(solver.graph());
    const Eigen::MatrixXd expected =
        test::informationOfFactors(solver.graph(), dense).topLeftCorner(dense.size(), dense.size());
    const Eigen::MatrixXd folded =
        test::informationOfTree(solver.tree(), dense).topLeftCorner(dense.size(), dense.size());
    EXPECT_THAT(folded, IsNear(expected, 1e-9 * expected.cwiseAbs().maxCoeff()));
  }
}

TEST(IncrementalSolver, CovariancesEqualTheDenseInverse) {
  IncrementalSolver solver(kExact);
  MultibodyGraph graph(solver, 5, 3);
  for (int i = 0; i < 12; ++i) {
    graph.addFrame();
    solver.update();
    if (i >= 8) solver.retire(graph.takeOldest());
  }
  for (int i = 0; i < 10; ++i) solver.update();
  const DenseSystem dense(solver.graph());
  const Eigen::MatrixXd covariance = test::inverted(dense.linearized().first);
  const auto& object = graph.objects()[1];
  for (const auto& chosen :
       {std::vector{graph.camera().back()}, std::vector{graph.camera()[1], object.anchor, object.poses.back()},
        std::vector{object.poses.back(), graph.camera().back()}}) {
    std::vector<int> at;
    for (const VariableId v : chosen)
      for (int i = 0; i < 6; ++i) at.push_back(dense.offset(v) + i);
    const Eigen::MatrixXd expected = covariance(at, at);
    const auto actual = solver.jointCovariance(chosen);
    ASSERT_TRUE(actual);
    EXPECT_LT((*actual - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.cwiseAbs().maxCoeff());
  }
}

TEST(IncrementalSolver, RetiringDoesNotChangeTheSolution) {
  IncrementalSolver solver(kExact);
  MultibodyGraph graph(solver, 9, 3);
  for (int i = 0; i < 12; ++i) {
    graph.addFrame();
    solver.update();
  }
  for (int i = 0; i < 10; ++i) solver.update();
  const SE3 before = solver.pose(graph.camera().back());
  const auto covariance = solver.jointCovariance(std::vector{graph.camera().back()});
  for (int i = 0; i < 6; ++i) solver.retire(graph.takeOldest());
  for (int i = 0; i < 3; ++i) solver.update();
  EXPECT_THAT(solver.pose(graph.camera().back()), IsNearPose(before, 1e-8));
  EXPECT_THAT(*solver.jointCovariance(std::vector{graph.camera().back()}), IsNear(*covariance, 1e-9));
}

TEST(IncrementalSolver, EveryNReordersAndRelinearizesOnSchedule) {
  IncrementalSolver::Params params = kExact;
  params.policy = IncrementalSolver::Policy::kEveryN;
  params.batch_every_updates = 5;
  IncrementalSolver solver(params);
  MultibodyGraph graph(solver, 1, 2);
  for (int i = 1; i <= 23; ++i) {
    graph.addFrame();
    const auto& report = solver.update();
    EXPECT_EQ(report.relinearized_factors > 0, i % 5 == 0);
    const auto counters = solver.counters();
    EXPECT_EQ(counters.updates, i);
    EXPECT_EQ(counters.relinearizations, i / 5);
    EXPECT_EQ(counters.reorderings, i / 5);
    EXPECT_EQ(counters.batch_solves, i / 5);
  }
}

TEST(IncrementalSolver, WorkAndMemoryStayBoundedWithAWindow) {
  IncrementalSolver solver({});
  MultibodyGraph graph(solver, 2, 3);
  std::size_t early = 0, largest = 0;
  std::int64_t most_scalars = 0;
  for (int i = 0; i < 600; ++i) {
    graph.addFrame();
    const auto& report = solver.update();
    if (i >= 30) solver.retire(graph.takeOldest());
    if (i >= 100 && i < 300) early = std::max(early, test::matrixBytes(solver.tree()));
    if (i >= 300) largest = std::max(largest, test::matrixBytes(solver.tree()));
    if (i >= 300) most_scalars = std::max(most_scalars, report.eliminated_scalars);
  }
  EXPECT_EQ(solver.counters().variables, 30 + 3 * 31);
  EXPECT_LT(largest, early * 3 / 2);
  EXPECT_LE(most_scalars, 2 * 6 * (31 + 3 * 32));  // at most the whole window in each of two iterations
}

TEST(IncrementalSolver, NamesAnUnconstrainedVariableAndGoesOn) {
  IncrementalSolver solver({});
  MultibodyGraph graph(solver, 4, 1);
  graph.addFrame();
  const VariableId loose = solver.addVariable(SE3{});
  const auto& report = solver.update();
  ASSERT_EQ(report.problems.size(), 1U);
  EXPECT_EQ(report.problems[0].variable, loose);
  EXPECT_TRUE(solver.drop(std::vector{loose}).problems.empty());
  graph.addFrame();
  EXPECT_TRUE(solver.update().problems.empty());
}

TEST(IncrementalSolver, DroppingAnObjectLeavesTheProblemWithoutIt) {
  IncrementalSolver solver(kExact);
  MultibodyGraph graph(solver, 6, 3);
  for (int i = 0; i < 12; ++i) {
    graph.addFrame();
    solver.update();
    if (i >= 8) solver.retire(graph.takeOldest());
  }
  auto variables = graph.objects()[1].poses;
  variables.push_back(graph.objects()[1].anchor);
  solver.drop(variables);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(solver.update().problems.empty());
  EXPECT_LT(differenceFromBatch(solver), 1e-8);
}

TEST(IncrementalSolver, LeavesOutAFactorThatIsNotFinite) {
  IncrementalSolver solver({});
  const VariableId v = solver.addVariable(SE3{});
  const SE3 broken(Eigen::Matrix3d::Identity(), {std::nan(""), 0, 0});
  EXPECT_FALSE(solver.addFactor(std::make_unique<PriorFactor>(std::array{v}, PriorModel{broken}, PoseNoise{})));
  EXPECT_TRUE(solver.addFactor(std::make_unique<PriorFactor>(std::array{v}, PriorModel{}, PoseNoise{})));
  const auto& report = solver.update();
  ASSERT_EQ(report.problems.size(), 1U);
  EXPECT_EQ(report.problems[0].kind, SolverProblem::Kind::kNotFinite);
  EXPECT_TRUE(solver.update().problems.empty());
}

}  // namespace
}  // namespace motorcade
