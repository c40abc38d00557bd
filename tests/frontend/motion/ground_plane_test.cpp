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
    points.push_back({above(plane, x, z, height + noise.gaussian(0.02 + sigma)), sigma / plane.height_m});
  }
  return points;
}

/// Road, as the frames see it one after the other.
GroundPlane after(GroundPlaneEstimator& estimate, const GroundPlane& plane, int first, int end) {
  GroundPlane found;
  for (int frame = first; frame < end; ++frame)
    found = estimate(roadWithClutter(plane, 150, static_cast<std::uint64_t>(frame)), static_cast<std::uint64_t>(frame));
  return found;
}

TEST(GroundPlane, ATiltedRoadIsFoundUnderFortyPercentClutter) {
  GroundPlaneEstimator estimate({});
  const GroundPlane plane = after(estimate, kTilted, 0, 20);
  // Within the fit's 2.5 tolerances lie a tenth of the clutter, at 0.1 m on average, and the memory holds 0.1 % of the
  // first guess.
  EXPECT_NEAR(plane.height_m, kTilted.height_m, 0.04);
  EXPECT_THAT(plane.normal_cam, IsNear(kTilted.normal_cam, 0.005));
}

TEST(GroundPlane, TooFewPointsKeepTheLastPlane) {
  GroundPlaneEstimator estimate({});
  EXPECT_EQ(estimate({}, 0).height_m, GroundPlaneEstimator::Params{}.initial_height_m);
  const GroundPlane before = after(estimate, kTilted, 1, 2);
  const GroundPlane now = estimate(roadWithClutter({{0, 1, 0}, 1.9}, 12, 2), 2);
  EXPECT_EQ(now.height_m, before.height_m);
  EXPECT_EQ(now.normal_cam, before.normal_cam);
}

TEST(GroundPlane, ARoofOrAWallIsNoRoad) {
  GroundPlaneEstimator estimate({});
  const GroundPlane before = after(estimate, kTilted, 0, 10);
  std::vector<GroundCandidate> wall;
  Noise noise(2);
  for (int i = 0; i < 100; ++i)
    wall.push_back({{noise.uniform(3.9, 4.1), noise.uniform(0.5, 5), noise.uniform(5, 25)}, 0.01});
  const GroundPlane now = estimate(wall, 2);
  EXPECT_THAT(now.normal_cam, IsNear(before.normal_cam, 0.03));
  EXPECT_NEAR(now.height_m, before.height_m, 0.1);
}

/// Cameras on lorries look down, those on robots stand low.
TEST(GroundPlane, ATiltedOrLowCameraFindsItsRoad) {
  for (const GroundPlane& road : {GroundPlane{Eigen::Vector3d(0.03, 1, 0.3).normalized(), 2.9},
                                  GroundPlane{Eigen::Vector3d(0.1, 1, 0.2).normalized(), 1.2},
                                  GroundPlane{Eigen::Vector3d(0, 1, 0.02).normalized(), 0.5}}) {
    GroundPlaneEstimator estimate({});
    const GroundPlane found = after(estimate, road, 0, 25);
    EXPECT_NEAR(found.height_m, road.height_m, 0.06);
    EXPECT_THAT(found.normal_cam, IsNear(road.normal_cam, 0.01));
  }
}

/// For a while, something else that is flat shows more points than the road.
TEST(GroundPlane, WhatIsFarFromTheMountingIsNoRoadHoweverManyPointsLieOnIt) {
  const GroundPlane embankment{Eigen::Vector3d(0.1, 1, -0.05).normalized(), 1.0};
  GroundPlaneEstimator estimate({});
  after(estimate, kTilted, 0, 30);
  GroundPlane found;
  for (std::uint64_t frame = 30; frame < 50; ++frame) {
    auto points = roadWithClutter(embankment, 200, frame);
    const auto road = roadWithClutter(kTilted, 100, frame + 100);
    points.insert(points.end(), road.begin(), road.end());
    found = estimate(points, frame);
    ASSERT_NEAR(found.height_m, kTilted.height_m, 0.15) << "frame " << frame;
    ASSERT_THAT(found.normal_cam, IsNear(kTilted.normal_cam, 0.03)) << "frame " << frame;
  }
}

/// The mounting is a median, which follows what stays.
TEST(GroundPlane, ARoadThatIsSurelySeenIsBelieved) {
  const GroundPlane ramp{Eigen::Vector3d(0.03, 1, -0.16).normalized(), 1.5};
  GroundPlaneEstimator estimate({});
  after(estimate, kTilted, 0, 30);
  EXPECT_THAT(after(estimate, ramp, 30, 40).normal_cam, IsNear(ramp.normal_cam, 0.02));
}

TEST(GroundPlane, APointIsOnTheGroundAsFarAsItsNoiseTells) {
  GroundPlaneEstimator estimate({});
  const GroundPlane plane = after(estimate, kTilted, 1, 2);
  EXPECT_TRUE(estimate.isOnGround({above(plane, 2, 15, 0.05), 0.01}));
  EXPECT_FALSE(estimate.isOnGround({above(plane, 2, 15, 0.2), 0.01}));
  EXPECT_TRUE(estimate.isOnGround({above(plane, 2, 60, 0.2), 0.2}));
  EXPECT_FALSE(estimate.isOnGround({above(plane, 2, 60, 0.8), 2}));  // a car's side, however far
}

}  // namespace
}  // namespace motorcade
