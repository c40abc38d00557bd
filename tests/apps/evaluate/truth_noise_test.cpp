#include "apps/evaluate/comparison/truth_noise.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/messages.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

constexpr int kFrames = 2000;
constexpr double kGyroscopes_rad = 0.01 * std::numbers::pi / 180;

std::vector<SE3> arc() {
  std::vector<SE3> poses;
  for (int k = 0; k < kFrames; ++k) poses.push_back(SE3::exp(k * (Vector6d() << 0, 0, 1, 0, 0.01, 0).finished()));
  return poses;
}

TEST(TruthNoise, WhiteNoiseOfPosesIsFoundInTheErrorsOfSuccessiveMotions) {
  test::Noise noise(3);
  Vector6d sigma;
  sigma << 0.02, 0.01, 0.03, 0.0004, 0.0002, 0.0003;
  std::vector<SE3> truth = arc();
  for (SE3& pose : truth) pose = pose * SE3::exp(noise.gaussian(sigma));
  const Matrix6d found = truthNoise(arc(), truth);
  for (int k = 0; k < 6; ++k)
    EXPECT_NEAR(found(k, k), 2 * sigma[k] * sigma[k] + (k < 3 ? 0 : std::pow(kGyroscopes_rad, 2)),
                0.4 * sigma[k] * sigma[k])
        << k;
}

/// Adds errors that last, as those of a wrong calibration do.
TEST(TruthNoise, ErrorsThatLastAreNone) {
  std::vector<SE3> estimate = arc();
  for (int k = 0; k < kFrames; ++k) estimate[k] = SE3::exp(k * (Vector6d() << 0.001, 0, 1.01, 0, 0.0102, 0).finished());
  const Matrix6d found = truthNoise(estimate, arc());
  EXPECT_NEAR((found.topLeftCorner<3, 3>().norm()), 0, 1e-9);
  EXPECT_NEAR(found(4, 4), std::pow(kGyroscopes_rad, 2), 1e-12);
}

TEST(TruthNoise, OfPlacesIsHowFarTheyDifferFromWhereVelocitiesLead) {
  std::vector<SE3> too_fast;
  for (int k = 0; k < kFrames; ++k) too_fast.push_back(SE3::exp(k * (Vector6d() << 0, 0, 1.01, 0, 0.01, 0).finished()));
  const Eigen::Matrix3d found = placeNoise(arc(), too_fast);
  EXPECT_NEAR(std::sqrt(found.trace()), 0.01 * kCameraCovarianceFrames, 2e-3);
}

}  // namespace
}  // namespace motorcade
