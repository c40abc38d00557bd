#include "frontend/shape/point_extent.hpp"

#include <gtest/gtest.h>

#include "tests/support/noise.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

/// Body axes: x along the view, y to the left, z up. The body is 10 m ahead.
const SE3 kT_cam_body((Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished(), {0, 0.5, 10});

/// Points evenly over 4 x 1.6 x 1.4 m, whose disparity is known to `sigma_px`.
std::vector<PointMeasurement> pointsOfACar(std::size_t count, float sigma_px) {
  test::Noise noise(1);
  std::vector<PointMeasurement> points;
  while (points.size() < count) {
    const Eigen::Vector3d p_body = noise.inBox({-2, -0.8, -0.7}, {2, 0.8, 0.7});
    points.push_back({{}, kRig.project(kT_cam_body * p_body)->cast<float>(), {0.3F, 0.3F, sigma_px}});
  }
  return points;
}

TEST(PointExtent, LeavesOutATenthAtEachSide) {
  const auto box = extentOf(pointsOfACar(2000, 0.25F), kRig, kT_cam_body.inverse(), 0).box;
  ASSERT_TRUE(box);
  EXPECT_LT((box->sizes() - 0.8 * Eigen::Vector3d(4, 1.6, 1.4)).cwiseAbs().maxCoeff(), 0.15);
  EXPECT_FALSE(extentOf(pointsOfACar(4, 0.25F), kRig, kT_cam_body.inverse(), 0).box);
}

TEST(PointExtent, IsSureWithoutAFifthAtEachSideAndTheNoiseOfDepth) {
  const auto exact = extentOf(pointsOfACar(2000, 0.001F), kRig, kT_cam_body.inverse(), 0).sure;
  ASSERT_TRUE(exact);
  EXPECT_LT((exact->sizes() - 0.6 * Eigen::Vector3d(4, 1.6, 1.4)).cwiseAbs().maxCoeff(), 0.15);
  const double noise_m = 10 * 10 / (kRig.fx_px * kRig.baseline_m);  // of a pixel, 10 m ahead
  const auto noisy = extentOf(pointsOfACar(2000, 1), kRig, kT_cam_body.inverse(), 0).sure;
  ASSERT_TRUE(noisy);
  EXPECT_NEAR(noisy->sizes().x(), exact->sizes().x() - 4 * noise_m, 0.3 * noise_m);
  EXPECT_NEAR(noisy->sizes().y(), exact->sizes().y(), 0.3 * noise_m) << "across the view depth matters little";
  EXPECT_LT(extentOf(pointsOfACar(2000, 10), kRig, kT_cam_body.inverse(), 0).sure->sizes().x(), 0);
  EXPECT_FALSE(extentOf(pointsOfACar(9, 0.25F), kRig, kT_cam_body.inverse(), 0).sure);
}

TEST(SureSizes, CountWhereFiveFramesReachThem) {
  SureSizes sizes;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(sizes.add({9, 3, 3}), Eigen::Vector3d::Zero()) << "with points of another body";
  EXPECT_EQ(sizes.add({2, 1, -1}), Eigen::Vector3d(2, 1, 0));
  EXPECT_EQ(sizes.add({3, 0.5, 1}), Eigen::Vector3d(3, 1, 1));
  EXPECT_EQ(sizes.add({1, 2, 0.5}), Eigen::Vector3d(3, 2, 1));
}

}  // namespace
}  // namespace motorcade
