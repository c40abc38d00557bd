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

}  // namespace
}  // namespace motorcade
