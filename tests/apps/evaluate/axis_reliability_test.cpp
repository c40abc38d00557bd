#include "apps/evaluate/measures/axis_reliability.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::Noise;

TEST(AxisReliability, CountsErrorsByTheProbabilityThatTheyAreSmaller) {
  AxisReliability reliability;
  const Vector6d error = (Vector6d() << 0.1, -0.6, 1.3, 0, -1.6, 40).finished();
  reliability.add(error, Matrix6d::Identity());
  for (const auto& [axis, tenth] : {std::pair(0, 0), {1, 4}, {2, 8}, {3, 0}, {4, 8}, {5, 9}})
    EXPECT_EQ(reliability.errors[axis][tenth], 1) << axis;
  EXPECT_EQ(reliability.samples(), 1);
  EXPECT_EQ(reliability.shareWithin(1, 4), 0);
  EXPECT_EQ(reliability.shareWithin(1, 5), 1);
}

/// Rotations claim half of the deviation that they have.
TEST(AxisReliability, FindsAsManyErrorsAsClaimedWhereDeviationsAreRight) {
  Noise noise(5);
  AxisReliability reliability, half;
  constexpr int kErrors = 4000;
  for (int i = 0; i < kErrors; ++i) {
    Vector6d sigma = (Vector6d() << 0.1, 0.2, 0.3, 0.01, 0.02, 0.03).finished();
    Vector6d error;
    for (int axis = 0; axis < 6; ++axis) error[axis] = noise.gaussian(sigma[axis]);
    sigma.tail<3>() /= 2;
    (i % 2 == 0 ? reliability : half).add(error, Matrix6d(sigma.cwiseAbs2().asDiagonal()));
  }
  reliability.add(half);
  EXPECT_EQ(reliability.samples(), kErrors);
  constexpr double kFourSigma = 0.032, kWithinHalfOf80Percent = 0.478;  // P(|z| < 1.2816 / 2)
  for (int axis = 0; axis < 6; ++axis)
    EXPECT_NEAR(reliability.shareWithin(axis, 8), axis < 3 ? 0.8 : kWithinHalfOf80Percent, kFourSigma) << axis;
}

TEST(AxisReliability, ComesBackFromJson) {
  AxisReliability reliability;
  reliability.add(Vector6d::Ones(), Matrix6d::Identity());
  EXPECT_EQ(axisReliabilityOf(nlohmann::json::parse(jsonOf(reliability).dump())).errors, reliability.errors);
  EXPECT_THROW(axisReliabilityOf(nlohmann::json::parse(R"({"x": [1, 2]})")), nlohmann::json::exception);
}

}  // namespace
}  // namespace motorcade
