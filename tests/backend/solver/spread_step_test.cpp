#include <array>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "backend/factors/pose_factors.hpp"
#include "backend/solver/incremental_solver.hpp"
#include "tests/backend/random_graphs.hpp"

/// Steps that spread over several updates.
namespace motorcade {
namespace {

/// A long straight path, whose end is then measured elsewhere.
struct LongPath {
  static constexpr int kPoses = 300;

  explicit LongPath(const IncrementalSolver::Params& params) : solver(params) {
    const SE3 step(Eigen::Matrix3d::Identity(), {1, 0, 0});
    for (int k = 0; k < kPoses; ++k) {
      x.push_back(solver.addVariable(k == 0 ? SE3{} : solver.pose(x.back()) * step));
      if (k == 0)
        measure(x[0], SE3{});
      else
        solver.addFactor(std::make_unique<MotionFactor>(std::array{x[k - 1], x[k]}, MotionModel{step},
                                                        test::isotropicNoise(0.05, 0.01)));
      solver.update();
    }
    measure(x.back(), solver.pose(x.back()) * SE3(expSO3({0, 0, 0.3}), {0, 20, 0}));
  }
  void measure(VariableId v, const SE3& pose) {
    solver.addFactor(std::make_unique<PriorFactor>(std::array{v}, PriorModel{pose}, test::isotropicNoise(0.01, 0.01)));
  }

  IncrementalSolver solver;
  std::vector<VariableId> x;
};

TEST(SpreadStep, WhereTheTimeIsOverTheRestFollowsLater) {
  IncrementalSolver::Params params;
  params.budget.ms = 1e-9;
  LongPath path(params);
  EXPECT_GT(path.solver.update().waiting_scalars, 0);
  int updates = 0;
  while (path.solver.update().waiting_scalars > 0) ASSERT_LT(++updates, 1000);
  EXPECT_EQ(LongPath({}).solver.update().waiting_scalars, 0) << "without a limit nothing waits";
}

/// The estimate is bent at the front of a spreading step: no model may be corrected for that.
TEST(SpreadStep, ModelsAreComparedWhenAllTheirVariablesHaveFollowedAStep) {
  IncrementalSolver::Params params;
  params.spread_scalars = 30;
  params.iterations_per_update = 1;
  params.relinearization.jacobian_drift_sigmas = 1e9;
  params.relinearization.relinearize_rad = params.relinearization.leisurely_rad = 10;  // residuals alone
  LongPath path(params);
  path.solver.update();
  const auto hasMoved = [&](VariableId v) { return path.solver.graph().states()[v].x[1] > 1e-6; };
  std::vector<FactorId> half_followed;
  for (const FactorId f : path.solver.graph().factors()) {
    const auto variables = path.solver.graph().variablesOf(f);
    if (hasMoved(variables.back()) && !hasMoved(variables.front())) half_followed.push_back(f);
  }
  ASSERT_EQ(half_followed.size(), 1U);
  path.solver.update();
  EXPECT_EQ(path.solver.graph().models().drift(half_followed[0]), 0) << "corrected where the estimate was bent";
}

SE3 along(const Eigen::Vector3d& translation_m) { return {Eigen::Matrix3d::Identity(), translation_m}; }

/// A path with measurements between every two and three successive poses, which contradict each other.
struct ContradictedPath {
  static constexpr int kPoses = 100;

  explicit ContradictedPath(const IncrementalSolver::Params& params) : solver(params) {
    test::RandomPoses random(1);
    for (int k = 0; k < kPoses; ++k) {
      x.push_back(solver.addVariable(along({1.0 * k, 0, 0})));
      if (k == 0) measure(0);
      for (const int before : {1, 2})
        if (k >= before)
          solver.addFactor(std::make_unique<MotionFactor>(
              std::array{x[k - before], x[k]}, MotionModel{along({1.0 * before, 0, 0}) * random.pose(0.05, 0.01)},
              test::isotropicNoise(0.05, 0.01)));
      solver.update();
    }
    solver.update();
  }
  /// Measures a pose a little beside where it is. Most poses before it then make small steps.
  void measureBeside(int k, double error_m) {
    const SE3 pose = solver.pose(x[k]) * along({0, error_m, 0});
    solver.addFactor(std::make_unique<PriorFactor>(std::array{x[k]}, PriorModel{pose}, test::isotropicNoise(0.01, 1)));
  }
  void measure(int k) { measureBeside(k, 0); }

  IncrementalSolver solver;
  std::vector<VariableId> x;
};

IncrementalSolver::Params spreadingEvery(int updates) {
  IncrementalSolver::Params params;
  params.spread_every_updates = updates;
  params.cached_bytes = 0;
  return params;
}

constexpr int kLastPose = ContradictedPath::kPoses - 1;
constexpr double kSmallStep_m = 0.005;  // a fifth of the conditional standard deviation of a pose with four motions

TEST(SpreadStep, SmallStepsSpreadInEveryFewUpdates) {
  ContradictedPath path(spreadingEvery(4)), at_once(spreadingEvery(1));
  int waited = 0;
  for (int i = 0; i < 12; ++i) {
    for (ContradictedPath* p : {&path, &at_once}) p->measureBeside(kLastPose, kSmallStep_m);
    EXPECT_EQ(at_once.solver.update().waiting_scalars, 0);
    const auto waiting = path.solver.update().waiting_scalars;
    EXPECT_TRUE(waiting == 0 || path.solver.counters().updates % 4 != 0);
    if (waiting > 0) ++waited;
  }
  EXPECT_GE(waited, 6);
  for (const VariableId v : path.x)
    EXPECT_LT((path.solver.pose(v).translation() - at_once.solver.pose(v).translation()).norm(), kSmallStep_m);
}

TEST(SpreadStep, FarStepsSmallSystemsQuietUpdatesAndTheLastOneLetNothingWait) {
  ContradictedPath path(spreadingEvery(1000));
  path.measureBeside(kLastPose, kSmallStep_m);
  EXPECT_GT(path.solver.update().waiting_scalars, 0);
  EXPECT_EQ(path.solver.update().waiting_scalars, 0) << "a quiet update";
  path.measureBeside(kLastPose, kSmallStep_m);
  path.solver.spreadAllNext();
  EXPECT_EQ(path.solver.update().waiting_scalars, 0) << "the last update";
  const SE3 before = path.solver.pose(path.x[kLastPose / 2]);
  path.measureBeside(kLastPose, 100 * kSmallStep_m);
  path.solver.update();
  EXPECT_GT((path.solver.pose(path.x[kLastPose / 2]).translation() - before.translation()).norm(), kSmallStep_m)
      << "a far step";
  IncrementalSolver::Params params = spreadingEvery(1000);
  params.cached_bytes = 1 << 30;
  ContradictedPath small(params);
  small.measureBeside(kLastPose, kSmallStep_m);
  EXPECT_EQ(small.solver.update().waiting_scalars, 0) << "a small system";
}

}  // namespace
}  // namespace motorcade
