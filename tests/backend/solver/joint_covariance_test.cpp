#include <array>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "backend/solver/incremental_solver.hpp"
#include "tests/backend/dense_system.hpp"
#include "tests/backend/perturbation.hpp"
#include "tests/backend/random_factors.hpp"
#include "tests/backend/tree_information.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::DenseSystem;
using test::IsNear;
using test::kExact;
using test::local;
using test::RandomWorld;
using test::updateUntilStill;

/// A trajectory with closures, whose measurements really have the noise that its factors state.
class Trajectory {
 public:
  Trajectory(IncrementalSolver& solver, std::uint64_t seed, RandomWorld::Kind kind, double start_scale = 1)
      : solver_(solver), world_(seed, kind) {
    variables_.push_back(world_.addVariable(solver_));
    solver_.addFactor(world_.prior(variables_[0], start_scale));
    solver_.update();
  }

  void extend() {
    const VariableId before = variables_.back(), v = world_.addVariable(solver_);
    solver_.addFactor(world_.between(before, v, true));
    if (!world_.tiesFully(before, v)) solver_.addFactor(world_.prior(v));
    if (world_.below(3) == 0) solver_.addFactor(world_.between(any(), v, true));
    variables_.push_back(v);
    solver_.update();
  }
  void retireOldest() {
    solver_.retire(std::array{variables_.front()});
    variables_.erase(variables_.begin());
  }

  VariableId any() { return variables_[world_.below(variables_.size())]; }
  /// One to three different ones.
  std::vector<VariableId> some() {
    std::vector<VariableId> chosen{any()};
    for (int i = 0; i < 2; ++i)
      if (const VariableId v = any(); std::ranges::find(chosen, v) == chosen.end()) chosen.push_back(v);
    return chosen;
  }
  const std::vector<VariableId>& variables() const { return variables_; }
  RandomWorld& world() { return world_; }

 private:
  IncrementalSolver& solver_;
  RandomWorld world_;
  std::vector<VariableId> variables_;
};

/// Compares each entry relative to the standard deviations of its row and column.
void expectDenseInverse(const IncrementalSolver& solver, std::span<const VariableId> chosen) {
  const DenseSystem dense(solver.graph());
  const Eigen::MatrixXd covariance = test::inverted(dense.linearized().first);
  const auto at = dense.entries(chosen);
  const Eigen::MatrixXd expected = covariance(at, at);
  const Eigen::VectorXd sigma = expected.diagonal().cwiseSqrt();
  const auto actual = solver.jointCovariance(chosen);
  ASSERT_TRUE(actual);
  const Eigen::MatrixXd relative =
      sigma.cwiseInverse().asDiagonal() * (*actual - expected) * sigma.cwiseInverse().asDiagonal();
  EXPECT_LT(relative.cwiseAbs().maxCoeff(), 1e-6);
}

TEST(JointCovariance, EqualsTheDenseInverseAfterManyUpdates) {
  for (std::uint64_t seed = 0; seed < 32; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    IncrementalSolver solver(kExact);
    Trajectory trajectory(solver, seed, RandomWorld::kKinds[seed % 4]);
    for (std::uint64_t i = 0; i < 5 + 2 * seed; ++i) trajectory.extend();
    solver.converge(100, 1e-10);
    for (int i = 0; i < 4; ++i) expectDenseInverse(solver, trajectory.some());
  }
}

TEST(JointCovariance, EqualsTheDenseInverseAfterRetirement) {
  for (std::uint64_t seed = 0; seed < 32; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    IncrementalSolver solver(kExact);
    Trajectory trajectory(solver, seed, RandomWorld::kKinds[seed % 4]);
    for (int i = 0; i < 40; ++i) {
      trajectory.extend();
      if (i > 10) trajectory.retireOldest();
    }
    solver.converge(100, 1e-10);
    for (int i = 0; i < 4; ++i) expectDenseInverse(solver, trajectory.some());
  }
}

/// The whole trajectory turns and moves when a sure measurement of its end comes: its start is known to 2 m and 0.4 rad
/// only.
Trajectory swungTrajectory(IncrementalSolver& solver, std::uint64_t seed) {
  Trajectory trajectory(solver, seed, seed % 2 == 0 ? RandomWorld::Kind::kSpace : RandomWorld::Kind::kPlane, 40);
  for (int i = 0; i < 12; ++i) trajectory.extend();
  const Value before = solver.estimate(trajectory.variables()[5]);
  solver.addFactor(trajectory.world().prior(trajectory.variables().back(), 0.1));
  updateUntilStill(solver);
  EXPECT_GT(displacement(before, solver.estimate(trajectory.variables()[5])).norm(), 0.3);
  return trajectory;
}

TEST(JointCovariance, EqualsTheDenseInverseAfterALargeMotion) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    IncrementalSolver solver(kExact);
    Trajectory trajectory = swungTrajectory(solver, seed);
    for (int i = 0; i < 4; ++i) expectDenseInverse(solver, trajectory.some());
  }
}

/// Takes steps in the world's axes to right perturbations of a pose.
Eigen::MatrixXd turnOf(const Value& value) {
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(dimension(value), dimension(value));
  if (const auto* pose = std::get_if<SE3>(&value)) {
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = pose->rotation().transpose();
  } else if (const auto* planar = std::get_if<SE2>(&value)) {
    turn.topLeftCorner<2, 2>() = planar->rotation().transpose();
  }
  return turn;
}

/// The covariance is that of the linear models, under right perturbations of the present pose, although the Jacobians
/// stay where they were first taken.
TEST(JointCovariance, IsStatedWhereThePoseIsNotWhereItWasLinearized) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    IncrementalSolver::Params params = kExact;
    params.relinearization.jacobian_drift_sigmas = params.relinearization.relinearize_rad =
        params.relinearization.leisurely_rad = 1e9;
    IncrementalSolver solver(params);
    Trajectory trajectory = swungTrajectory(solver, seed);
    const DenseSystem dense(solver.graph());
    const Eigen::MatrixXd covariance =
        test::inverted(test::informationOfFactors(solver.graph(), dense).topLeftCorner(dense.size(), dense.size()));
    for (const VariableId v : trajectory.variables()) {
      const auto at = dense.entries(std::array{v});
      const Eigen::MatrixXd turn = turnOf(solver.estimate(v)), expected = turn * covariance(at, at) * turn.transpose();
      EXPECT_THAT(*solver.jointCovariance(std::array{v}), IsNear(expected, 1e-6 * expected.cwiseAbs().maxCoeff()))
          << "seed " << seed;
    }
  }
}

TEST(JointCovariance, MarginalsAreBlocksOfTheJoint) {
  IncrementalSolver solver(kExact);
  Trajectory trajectory(solver, 3, RandomWorld::Kind::kMixed);
  for (int i = 0; i < 30; ++i) trajectory.extend();
  const auto& all = trajectory.variables();
  const auto joint = solver.jointCovariance(all);
  ASSERT_TRUE(joint);
  EXPECT_THAT(*joint, IsNear(Eigen::MatrixXd(joint->transpose()), 1e-15));
  Eigen::Index at = 0;
  for (const VariableId v : all) {
    const int size = solver.graph().sizeOf(v);
    EXPECT_THAT(*solver.jointCovariance(std::array{v}),
                IsNear(Eigen::MatrixXd(joint->block(at, at, size, size)), 1e-10));
    at += size;
  }
}

TEST(JointCovariance, ThatOfLinearFunctionsFollowsFromTheJoint) {
  for (const auto kind : RandomWorld::kKinds) {
    IncrementalSolver solver(kExact);
    Trajectory trajectory(solver, 5, kind);
    for (int i = 0; i < 30; ++i) trajectory.extend();
    const auto& all = trajectory.variables();
    const std::array chosen{all.back(), all.front(), all[7]};
    const Eigen::MatrixXd joint = *solver.jointCovariance(chosen);
    const Eigen::MatrixXd J = Eigen::MatrixXd::NullaryExpr(
        2, joint.rows(), [](Eigen::Index row, Eigen::Index column) { return std::sin(3.0 * column + row); });
    constexpr double kRounding = 1e-12;
    const Eigen::MatrixXd expected = J * joint * J.transpose();
    EXPECT_THAT(*solver.jointCovariance(chosen, J), IsNear(expected, kRounding * (1 + expected.norm())));
    const int size = solver.graph().sizeOf(all.front());
    Eigen::MatrixXd difference(size, 2 * size);  // of a variable and itself
    difference << Eigen::MatrixXd::Identity(size, size), -Eigen::MatrixXd::Identity(size, size);
    EXPECT_LT(solver.jointCovariance(std::array{all.front(), all.front()}, difference)->norm(), kRounding);
  }
}

TEST(JointCovariance, IsEmptyForWhatTheTreeDoesNotHoldOrDoesNotDetermine) {
  IncrementalSolver solver(kExact);
  Trajectory trajectory(solver, 4, RandomWorld::Kind::kSpace);
  trajectory.extend();
  const VariableId waiting = solver.addVariable(SE3{});
  EXPECT_FALSE(solver.jointCovariance(std::array{waiting}));
  solver.update();
  EXPECT_FALSE(solver.jointCovariance(std::array{waiting}));
  EXPECT_TRUE(solver.jointCovariance(std::array{trajectory.variables()[0]}));
}

/// Normalized errors of the newest, the oldest and a middle variable of one seed, summed, and their degrees of freedom.
struct Nees {
  double sum = 0;
  int degrees = 0;
};

Nees neesOf(std::uint64_t seed, RandomWorld::Kind kind) {
  // The default thresholds: what users get.
  IncrementalSolver solver({});
  Trajectory trajectory(solver, seed, kind);
  for (int i = 0; i < 30; ++i) {
    trajectory.extend();
    if (i >= 15) trajectory.retireOldest();
  }
  const auto& variables = trajectory.variables();
  const std::vector<VariableId> chosen{variables.front(), variables[variables.size() / 2], variables.back()};
  const auto covariance = solver.jointCovariance(chosen);
  EXPECT_TRUE(covariance);
  Eigen::VectorXd error(covariance->rows());
  Eigen::Index at = 0;
  for (const VariableId v : chosen) {
    const SmallVector e = local(trajectory.world().truth(v), solver.estimate(v));
    error.segment(at, e.size()) = e;
    at += e.size();
  }
  return {error.dot(covariance->llt().solve(error)), static_cast<int>(at)};
}

/// The sum over 100 seeds is chi-square with all the degrees of freedom together, nearly normal; its mean lies in the
/// 95 % interval.
TEST(JointCovariance, NormalizedErrorsOverAHundredSeedsAreChiSquare) {
  for (const auto kind : RandomWorld::kKinds) {
    Nees total;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      const Nees nees = neesOf(1000 + seed, kind);
      total.sum += nees.sum;
      total.degrees += nees.degrees;
    }
    const double mean = total.sum / total.degrees, spread = test::meanChi2Spread(1, total.degrees);
    std::cout << "NEES per dimension " << mean << ", expected 1 +/- " << spread << "\n";
    EXPECT_NEAR(mean, 1, spread) << "kind " << static_cast<int>(kind);
  }
}

}  // namespace
}  // namespace motorcade
