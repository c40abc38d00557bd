#include "frontend/motion/ground_plane.hpp"

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::Noise;

const GroundPlane kTilted{Eigen::Vector3d(0.03, 1, -0.04).normalized(), 1.5};

/// `height_m` above the plane at (x, z).
Eigen::Vector3d above(const GroundPlane& plane, double x, double z, double height_m) {
  const Eigen::Vector3d& n = plane.normal_cam;
  return {x, (plane.height_m - height_m - n.x() * x - n.z() * z) / n.y(), z};
}

/// Road and, for two of five points, what stands on it: cars, curbs, walls.
std::vector<GroundCandidate> roadWithClutter(const GroundPlane& plane, int count, std::uint64_t seed) {
  Noise noise(seed);
  std::vector<GroundCandidate> points;
  for (int i = 0; i < count; ++i) {
    const double z = noise.uniform(5, 28), x = noise.uniform(-8, 8), sigma = 0.002 * z;
    const double height = i % 5 < 2 ? noise.uniform(0.05, 1.2) : 0;
    points.push_back({above(plane, x, z, height + noise.gaussian(0.02 + sigma)), sigma});
  }
  return points;
}

TEST(GroundPlane, ATiltedRoadIsFoundUnderFortyPercentClutter) {
  GroundPlaneEstimator estimate({});
  GroundPlane plane;
  for (std::uint64_t frame = 0; frame < 20; ++frame) plane = estimate(roadWithClutter(kTilted, 150, frame), frame);
  // Within the fit's 2.5 tolerances lie a tenth of the clutter, at 0.1 m on average, and the memory holds 0.1 % of the
  // first guess.
  EXPECT_NEAR(plane.height_m, kTilted.height_m, 0.04);
  EXPECT_THAT(plane.normal_cam, IsNear(kTilted.normal_cam, 0.005));
}

TEST(GroundPlane, TooFewPointsKeepTheLastPlane) {
  GroundPlaneEstimator estimate({});
  EXPECT_EQ(estimate({}, 0).height_m, GroundPlaneEstimator::Params{}.initial_height_m);
  const GroundPlane before = estimate(roadWithClutter(kTilted, 150, 1), 1);
  const GroundPlane after = estimate(roadWithClutter({{0, 1, 0}, 1.9}, 12, 2), 2);
  EXPECT_EQ(after.height_m, before.height_m);
  EXPECT_EQ(after.normal_cam, before.normal_cam);
}

TEST(GroundPlane, ARoofOrAWallIsNoRoad) {
  GroundPlaneEstimator estimate({});
  const GroundPlane before = estimate(roadWithClutter(kTilted, 150, 1), 1);
  std::vector<GroundCandidate> wall;
  Noise noise(2);
  for (int i = 0; i < 100; ++i)
    wall.push_back({{noise.uniform(3.9, 4.1), noise.uniform(0.5, 5), noise.uniform(5, 25)}, 0.02});
  const GroundPlane after = estimate(wall, 2);
  EXPECT_GT(after.normal_cam.y(), 0.99);  // the steepest road allowed leans by 0.12 rad
  EXPECT_NEAR(after.height_m, before.height_m, 0.5);
}

TEST(GroundPlane, APointIsOnTheGroundAsFarAsItsNoiseTells) {
  GroundPlaneEstimator estimate({});
  const GroundPlane plane = estimate(roadWithClutter(kTilted, 150, 1), 1);
  EXPECT_TRUE(estimate.isOnGround({above(plane, 2, 15, 0.05), 0.02}));
  EXPECT_FALSE(estimate.isOnGround({above(plane, 2, 15, 0.2), 0.02}));
  EXPECT_TRUE(estimate.isOnGround({above(plane, 2, 60, 0.2), 0.3}));
  EXPECT_FALSE(estimate.isOnGround({above(plane, 2, 60, 0.8), 3}));  // a car's side, however far
}

}  // namespace
}  // namespace motorcade
