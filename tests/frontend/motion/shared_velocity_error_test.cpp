#include "frontend/motion/shared_velocity_error.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

constexpr double kInTown_mps = 13;

double alongSigma_mps(const Eigen::Vector3d& p_cam, const Eigen::Vector3d& direction,
                      double camera_speed_mps = kInTown_mps) {
  return std::sqrt(direction.dot(sharedVelocityCovariance(kRig, p_cam, camera_speed_mps) * direction));
}

/// A disparity that changes by 0.15 px in a second moves a point along its ray, by the square of its depth.
TEST(SharedVelocityError, IsThatOfTheDisparityAlongTheRay) {
  const Eigen::Vector3d ray(0, 0, 1);
  const double fb = kRig.fx_px * kRig.baseline_m;
  EXPECT_NEAR(alongSigma_mps(200 * ray, ray), 200.0 * 200 * 0.15 / fb, 0.03) << "the camera's own motion adds little";
  EXPECT_NEAR(alongSigma_mps(200 * ray, ray) / alongSigma_mps(100 * ray, ray), 4, 0.1);
}

TEST(SharedVelocityError, IsThatOfTheCamerasMotionAcrossTheRay) {
  const Eigen::Vector3d ray(0.6, 0, 0.8), across(0.8, 0, -0.6);
  EXPECT_NEAR(alongSigma_mps(0.1 * ray, across), 0.25, 1e-3) << "its speed";
  EXPECT_NEAR(alongSigma_mps(1000 * ray, across), 3, 0.02) << "its turn rate";
}

TEST(SharedVelocityError, GrowsWithTheCamerasOwnSpeed) {
  const Eigen::Vector3d ray(0, 0, 1), across(1, 0, 0);
  EXPECT_NEAR(alongSigma_mps(0.1 * ray, across, 6.5), 0.125, 1e-3);
  EXPECT_NEAR(alongSigma_mps(200 * ray, ray, 6.5), 0.5 * alongSigma_mps(200 * ray, ray), 0.02);
  EXPECT_NEAR(alongSigma_mps(0.1 * ray, across, 0), 0.05, 1e-3) << "at rest";
  EXPECT_EQ(alongSigma_mps(0.1 * ray, across, 30), alongSigma_mps(0.1 * ray, across));
}

}  // namespace
}  // namespace motorcade
