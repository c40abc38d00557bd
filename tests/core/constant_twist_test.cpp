#include "core/constant_twist.hpp"

#include <gtest/gtest.h>

#include "core/fixed_product.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::IsNearPose;

const AccelerationNoise kNoise{
    .along_mps2 = 2, .sideways_mps2 = 1, .vertical_mps2 = 0.5, .yaw_radps2 = 0.3, .tilt_radps2 = 0.1};

ConstantTwistState carInABend() {
  Vector6d twist;
  twist << 9, 0.4, -0.1, 0.02, -0.03, 0.35;
  return {.T_world_body = SE3(expSO3({0.3, -1.2, 0.4}), {3, 1, 20}),
          .twist = twist,
          .covariance = 0.01 * Matrix12d::Identity()};
}

TEST(AccelerationNoise, ItsDensityIsInTheOrderOfTheTwist) {
  Vector6d expected;
  expected << 4, 1, 0.25, 0.01, 0.01, 0.09;
  EXPECT_THAT(kNoise.density(), IsNear(expected, 1e-15));
}

TEST(ConstantTwist, LookingBackUndoesAPredictionButForItsNoise) {
  const ConstantTwistState start = carInABend();
  ConstantTwistState state = start;
  state.predict(0.4, Vector6d::Zero());
  EXPECT_THAT(state.T_world_body, IsNearPose(start.T_world_body * SE3::exp(0.4 * start.twist), 1e-12));
  state.predict(-0.4, Vector6d::Zero());
  EXPECT_THAT(state.T_world_body, IsNearPose(start.T_world_body, 1e-12));  // rounding, here and below
  EXPECT_THAT(state.covariance, IsNear(start.covariance, 1e-12));

  state.predict(0.4, kNoise.density());
  state.predict(-0.4, kNoise.density());
  // The noise of both ways adds up: 0.8 s of the densities' sum.
  EXPECT_NEAR(state.velocityCovariance().trace(), start.velocityCovariance().trace() + 0.8 * 5.25, 1e-12);
}

TEST(ConstantTwist, CongruenceAndFixedProductsAreProducts) {
  test::Noise noise(1);
  Matrix12d A, P;
  Eigen::Matrix<double, 6, 12> J;
  for (double& a : A.reshaped()) a = noise.gaussian();
  for (double& p : P.reshaped()) p = noise.gaussian();
  for (double& j : J.reshaped()) j = noise.gaussian();
  constexpr double kTol = 1e-12;  // rounding, of sums of 144 terms
  EXPECT_THAT(congruence(A, P), IsNear(A * P * A.transpose(), kTol));
  EXPECT_THAT(fixedProduct(J, P), IsNear(J * P, kTol));
  const Eigen::Matrix<double, 12, 6> J_transposed = J.transpose();
  EXPECT_THAT(fixedProduct(J_transposed, J), IsNear(J_transposed * J, kTol));
}

}  // namespace
}  // namespace motorcade
