#include <gtest/gtest.h>

#include "backend/solver/incremental_solver.hpp"
#include "tests/backend/random_graphs.hpp"

namespace motorcade {
namespace {

constexpr int kCirclePoses = 400;
constexpr std::int64_t kCircleBudget = 700;  // of 2400 scalars: a closure takes several updates

constexpr double kSigma_m = 0.02;

/// A chain of poses round a circle, an update per pose.
class Circle {
 public:
  explicit Circle(IncrementalSolver& solver) : solver_(solver) {
    poses_.push_back(solver_.addVariable(SE3{}));
    solver_.addFactor(
        std::make_unique<PriorFactor>(std::array{poses_[0]}, PriorModel{}, test::isotropicNoise(1e-3, 1e-4)));
    for (int i = 1; i < kCirclePoses; ++i) {
      const SE3 step(expSO3({0, 2 * M_PI / kCirclePoses, 0}), {0, 0, 1});
      const SE3 measured = step * random_.pose(kSigma_m, 0.001);
      poses_.push_back(solver_.addVariable(solver_.pose(poses_.back()) * measured));
      measure(i - 1, i, measured);
      solver_.update();
    }
  }

  FactorId measure(int from, int to, const SE3& measured) {
    return *solver_.addFactor(std::make_unique<MotionFactor>(
        std::array{poses_[from], poses_[to]}, MotionModel{measured}, test::isotropicNoise(kSigma_m, 0.001)));
  }
  FactorId close(int from, int to) {
    const double turn_rad = 2 * M_PI / kCirclePoses * (to - from);
    const double radius_m = kCirclePoses / (2 * M_PI);
    return measure(
        from, to,
        SE3(expSO3({0, turn_rad, 0}), {radius_m * (1 - std::cos(turn_rad)), 0, radius_m * std::sin(turn_rad)}));
  }
  VariableId pose(int i) const { return poses_[i]; }

 private:
  IncrementalSolver& solver_;
  test::RandomPoses random_{1};
  std::vector<VariableId> poses_;
};

IncrementalSolver::Params withCircleBudget() {
  IncrementalSolver::Params params;
  params.budget.scalars = kCircleBudget;
  return params;
}

/// Distance of a pose after both have converged [m]; the solver without a budget is tested against dense batch
/// solutions.
double distance(IncrementalSolver& solver, IncrementalSolver& unlimited, VariableId v) {
  solver.converge(30, 1e-10);
  unlimited.converge(30, 1e-10);
  return (solver.pose(v).translation() - unlimited.pose(v).translation()).norm();
}

constexpr double kWaitingTol = 1e-6;  // m: rounding over a condition number of 1e7

TEST(WaitingFactors, AClosureIsSpreadOverUpdatesAndEndsAtTheBatchSolution) {
  IncrementalSolver solver(withCircleBudget()), unlimited({});
  Circle circle(solver), same(unlimited);
  for (Circle* c : {&circle, &same}) {
    c->close(1, kCirclePoses - 1);
    c->close(kCirclePoses / 2, kCirclePoses - 1);
  }
  unlimited.update();
  int updates = 0;
  std::int64_t most = 0;
  double waiting_chi2 = 0;
  for (; updates < 40; ++updates) {
    const auto& report = solver.update();
    most = std::max(most, report.eliminated_scalars);
    if (updates == 0) waiting_chi2 = report.waiting_chi2;
    if (report.waiting_factors == 0) break;
  }
  EXPECT_GE(updates, 2);
  EXPECT_LT(updates, 40);
  EXPECT_GT(waiting_chi2, 0);
  EXPECT_LE(most, 3 * kCircleBudget) << "the lift, what relinearization may take, and the newest cliques";
  EXPECT_EQ(solver.update().waiting_chi2, 0);
  EXPECT_LT(distance(solver, unlimited, circle.pose(kCirclePoses / 4)), kWaitingTol);
}

TEST(WaitingFactors, WithoutABudgetNothingWaits) {
  IncrementalSolver solver({});
  Circle circle(solver);
  circle.close(1, kCirclePoses - 1);
  EXPECT_EQ(solver.update().waiting_factors, 0);
}

TEST(WaitingFactors, LiftingLeavesTheSolution) {
  IncrementalSolver solver(withCircleBudget());
  Circle circle(solver);
  const SE3 before = solver.pose(circle.pose(kCirclePoses / 3));
  const auto covariance = *solver.jointCovariance(std::array{circle.pose(kCirclePoses - 1)});
  circle.close(1, kCirclePoses - 1);
  ASSERT_EQ(solver.update().waiting_factors, 1);
  EXPECT_LT((solver.pose(circle.pose(kCirclePoses / 3)).translation() - before.translation()).norm(), 1e-9);
  const auto after = *solver.jointCovariance(std::array{circle.pose(kCirclePoses - 1)});
  EXPECT_LT((after - covariance).norm(), 1e-8 * covariance.norm());  // rounding over a condition number of 1e7
}

TEST(WaitingFactors, LiftingKeepsTheOrderOfTheTree) {
  IncrementalSolver solver(withCircleBudget());
  Circle circle(solver);
  const FactorId closure = circle.close(1, kCirclePoses - 1);
  ASSERT_EQ(solver.update().waiting_factors, 1);
  const EliminationTree& tree = solver.tree();
  for (const int c : tree.cliques()) {
    if (tree[c].parent < 0) continue;
    EXPECT_LT(tree.sequence(c), tree.sequence(tree[c].parent));
  }
  for (const FactorId f : solver.graph().factors()) {
    const auto& owned = tree[tree.ownerOf(solver.graph().variablesOf(f))].factors;
    EXPECT_EQ(std::ranges::count(owned, f), f == closure ? 0 : 1);
  }
}

TEST(WaitingFactors, AWaitingFactorCanBeRemovedAndItsVariablesRetired) {
  IncrementalSolver solver(withCircleBudget()), unlimited({});
  Circle circle(solver), same(unlimited);
  const FactorId first = circle.close(1, kCirclePoses - 1);
  circle.close(kCirclePoses / 3, kCirclePoses - 1);
  same.close(kCirclePoses / 3, kCirclePoses - 1);
  unlimited.update();
  ASSERT_EQ(solver.update().waiting_factors, 2);
  solver.removeFactor(first);
  ASSERT_EQ(solver.update().waiting_factors, 1);
  solver.retire(std::array{circle.pose(kCirclePoses / 3)});
  EXPECT_EQ(solver.update().waiting_factors, 0);
  const std::array newest{circle.pose(kCirclePoses - 1)};
  const Eigen::MatrixXd known = *unlimited.jointCovariance(newest), left = *solver.jointCovariance(newest);
  EXPECT_LT((left - known).norm(), 0.1 * known.norm()) << "what the closure told stays, at its linearization";
  EXPECT_LT(distance(solver, unlimited, circle.pose(kCirclePoses / 4)), kSigma_m)
      << "a prior keeps the linearization of its time";
}

TEST(WaitingFactors, LeaveWithDroppedVariables) {
  IncrementalSolver solver(withCircleBudget());
  Circle circle(solver);
  circle.close(1, kCirclePoses - 1);
  ASSERT_EQ(solver.update().waiting_factors, 1);
  solver.drop(std::array{circle.pose(kCirclePoses - 1)});
  EXPECT_EQ(solver.update().waiting_factors, 0);
  EXPECT_LT(solver.converge(30, 1e-10).largest_change, 1e-9);
}

}  // namespace
}  // namespace motorcade
