#include "apps/bridge/path_covariance.hpp"

#include <cstdint>
#include <optional>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

#include "apps/bridge/message_conversion.hpp"
#include "tests/apps/results_by_hand.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/numeric_jacobian.hpp"

namespace motorcade::test {
namespace {

/// A drive at 10 m/s and 10 Hz along a bend, as the tracker reports it.
Result onBend(std::int64_t frame) {
  Result result;
  result.frame = frame;
  result.stamp_ns = frame * 100'000'000;
  SE3 T_world_cam;
  for (std::int64_t i = 0; i < frame; ++i) T_world_cam = T_world_cam * turned({0, 0, 0.02}, {1, 0, 0});
  result.T_world_cam = rowsOf(T_world_cam);
  if (frame > 0) result.velocity_covariance = rowsOf(diagonal(0.04, 0.0004));
  if (frame >= 10) result.motion_covariance = rowsOf(diagonal(0.01, 0.0001));
  return result;
}

TEST(PathCovariance, IsZeroInTheFirstFrameAndThatOfTheStepInTheSecond) {
  PathCovariance covariance;
  EXPECT_THAT(*covariance(onBend(0)), IsNear(Matrix6d(Matrix6d::Zero()), 0));
  EXPECT_THAT(*covariance(onBend(1)), IsNear(diagonal(0.0004, 0.000004), kRounding)) << "times the square of 0.1 s";
}

TEST(PathCovariance, OfTenFramesIsTheTrackersOwn) {
  PathCovariance covariance;
  std::optional<Matrix6d> last;
  for (int frame = 0; frame <= 10; ++frame) last = covariance(onBend(frame));
  EXPECT_THAT(*last, IsNear(diagonal(0.01, 0.0001), kRounding));
}

/// Two spans whose errors are the same draw, the worst case: the path's end, drawn exactly, stays within the bound.
TEST(PathCovariance, HoldsForSpansWithTheSameErrors) {
  PathCovariance covariance;
  std::optional<Matrix6d> bound;
  for (int frame = 0; frame <= 20; ++frame) bound = covariance(onBend(frame));
  const SE3 T_0_10 = transformOf(onBend(10).T_world_cam),
            T_10_20 = T_0_10.inverse() * transformOf(onBend(20).T_world_cam);
  const Matrix6d J = numericJacobian(  // of the path's end by the error that both spans have
      [&](const SE3& error) -> Vector6d {
        return ((T_0_10 * T_10_20).inverse() * T_0_10 * error * T_10_20 * error).log();
      },
      SE3());
  const Matrix6d actual = J * diagonal(0.01, 0.0001) * J.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> left(*bound - actual);
  EXPECT_GT(left.eigenvalues().minCoeff(), -1e-9);
  EXPECT_LT(bound->trace(), 2.5 * actual.trace()) << "a bound, but no guess";
  EXPECT_LT((*bound)(0, 0), 0.1);
}

TEST(PathCovariance, GrowsWithTheSquareOfTheSpans) {
  PathCovariance covariance;
  Matrix6d at_50 = Matrix6d::Zero(), at_100 = at_50;
  for (int frame = 0; frame <= 100; ++frame) {
    const Matrix6d now = *covariance(onBend(frame));
    if (frame == 50) at_50 = now;
    if (frame == 100) at_100 = now;
  }
  constexpr double kTol = 1e-9;
  EXPECT_NEAR(at_50(5, 5), 5 * 5 * 0.0001, kTol);
  EXPECT_NEAR(at_100(5, 5), 10 * 10 * 0.0001, kTol);
}

TEST(PathCovariance, IsNotKnownBehindAGapThatNothingLinks) {
  PathCovariance covariance;
  for (int frame = 0; frame < 15; ++frame) EXPECT_TRUE(covariance(onBend(frame)));
  for (int frame = 15; frame < 40; ++frame) {
    Result later = onBend(frame);
    later.segment = 1;
    EXPECT_FALSE(covariance(later)) << frame;
  }
}

TEST(PathCovariance, IsWideAfterAFrameThatWasNotMeasuredUntilASpanLeadsAcross) {
  PathCovariance covariance;
  for (int frame = 0; frame < 15; ++frame) covariance(onBend(frame));
  Result lost = onBend(15);
  lost.velocity_covariance = rowsOf(diagonal(900, 0.25));
  lost.motion_covariance.reset();
  constexpr double kVariance_m2 = 900 * 0.1 * 0.1;  // of the frame that was not measured
  const auto wide = covariance(lost);
  ASSERT_TRUE(wide);
  EXPECT_GE((*wide)(0, 0), kVariance_m2);
  const auto across = covariance(onBend(16));
  ASSERT_TRUE(across);
  EXPECT_LT((*across)(0, 0), kVariance_m2);
}

}  // namespace
}  // namespace motorcade::test
