#include "core/se3.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/numeric_jacobian.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::IsNearPose;
using test::numericJacobian;

/// Random twists from tiny to nearly half a turn.
std::vector<Vector6d> twists() {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<Vector6d> result;
  for (const double angle_rad : {0.0, 1e-9, 1e-5, 1e-4, 2e-3, 0.009, 0.011, 0.3, 1.5, 3.0}) {
    for (int i = 0; i < 20; ++i) {
      Vector6d xi;
      for (auto& x : xi) x = normal(random);
      xi.tail<3>() *= angle_rad / xi.tail<3>().norm();
      result.push_back(xi);
    }
  }
  return result;
}

TEST(SE3, LogarithmInvertsExponential) {
  for (const auto& xi : twists()) EXPECT_THAT(SE3::exp(xi).log(), IsNear(xi, 1e-9));
}

/// Choices depend on last bits, so both ways to write the product must give the same.
TEST(SE3, MovesPointsAsItsRotationAndTranslationDoToTheBit) {
  for (const auto& xi : twists()) {
    const SE3 T = SE3::exp(xi);
    const Eigen::Vector3d p(3 * xi[1], -20 * xi[2], 50 * xi[0]);
    EXPECT_EQ(T * p, T.rotation() * p + T.translation());
  }
}

TEST(SE3, InverseAndProductCancel) {
  for (const auto& xi : twists()) {
    const SE3 T = SE3::exp(xi);
    EXPECT_THAT(T * T.inverse(), IsNearPose(SE3{}, 1e-12));
    EXPECT_THAT(T * (T.inverse() * Eigen::Vector3d(1, 2, 3)), IsNear(Eigen::Vector3d(1, 2, 3), 1e-12));
  }
}

TEST(SE3, AdjointMovesAPerturbationThroughAPose) {
  const Vector6d d = 1e-3 * Vector6d::Ones();
  for (const auto& xi : twists()) {
    const SE3 T = SE3::exp(xi);
    EXPECT_THAT(T * SE3::exp(d) * T.inverse(), IsNearPose(SE3::exp(T.adjoint() * d), 1e-10));
  }
}

TEST(SE3, RightJacobianMatchesFiniteDifferences) {
  for (const auto& xi : twists()) {
    const auto residual = [&](const Vector6d& x) -> Vector6d { return (SE3::exp(xi).inverse() * SE3::exp(x)).log(); };
    EXPECT_THAT(rightJacobianSE3(xi), IsNear(numericJacobian(residual, xi), 1e-7));
  }
}

TEST(SE3, RightJacobianInverseMatchesFiniteDifferences) {
  for (const auto& xi : twists()) {
    const auto residual = [&](const SE3& T) { return T.log(); };
    EXPECT_THAT(rightJacobianInverseSE3(xi), IsNear(numericJacobian(residual, SE3::exp(xi)), 1e-5));
    EXPECT_THAT(rightJacobianInverseSE3(xi) * rightJacobianSE3(xi), IsNear(Matrix6d(Matrix6d::Identity()), 1e-6));
  }
}

TEST(SE3, ScaledMotionComposesToTheWhole) {
  for (const auto& xi : twists()) {
    const SE3 half = scaledMotion(SE3::exp(xi), 0.5);
    EXPECT_THAT(half * half, IsNearPose(SE3::exp(xi), 1e-9));
  }
}

TEST(SE3, IsFiniteWhenAllItsNumbersAre) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(isFinite(SE3(Eigen::Matrix3d::Identity(), {1e300, 0, 0})));
  EXPECT_FALSE(isFinite(SE3(Eigen::Matrix3d::Identity(), {0, kInf, 0})));
  EXPECT_FALSE(isFinite(SE3(kNan * Eigen::Matrix3d::Identity(), {0, 0, 0})));
}

}  // namespace
}  // namespace motorcade
