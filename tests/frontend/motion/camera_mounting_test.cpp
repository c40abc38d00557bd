#include "frontend/motion/camera_mounting.hpp"

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

const GroundPlane kAssumed{{0, 1, 0}, 1.65};

GroundPlane near(const GroundPlane& plane, test::Noise& noise) {
  const Eigen::Vector3d tilt = noise.inBox({-0.01, 0, -0.01}, {0.01, 0, 0.01});
  return {(plane.normal_cam + tilt).normalized(), plane.height_m + noise.uniform(-0.05, 0.05)};
}

TEST(CameraMounting, IsTheMedianOfPlanesOfWhichTwoInFiveAreWrong) {
  const GroundPlane road{Eigen::Vector3d(0.02, 1, 0.1).normalized(), 1.4};
  test::Noise noise(1);
  CameraMounting mounting(kAssumed);
  for (int i = 0; i < 200; ++i) {
    const bool wrong = i % 5 < 2;
    mounting.add(wrong ? GroundPlane{Eigen::Vector3d(-0.2, 1, 0).normalized(), noise.uniform(0.4, 1)}
                       : near(road, noise));
  }
  ASSERT_TRUE(mounting.isKnown());
  EXPECT_NEAR(mounting.plane().height_m, road.height_m, 0.05);
  EXPECT_THAT(mounting.plane().normal_cam, test::IsNear(road.normal_cam, 0.012));
}

TEST(CameraMounting, FavorsPlanesNearItAndBeforeItIsKnownThoseOfMostCars) {
  const GroundPlane road{{0, 1, 0}, 1.6}, low{{0, 1, 0}, 1.2}, tilted{Eigen::Vector3d(0, 1, 0.1).normalized(), 1.6};
  CameraMounting mounting(kAssumed);
  for (const GroundPlane& plane : {road, low, tilted}) EXPECT_EQ(mounting.likelihoodOf(plane), 1);
  EXPECT_LT(mounting.likelihoodOf({{0, 1, 0}, 0.5}), 0.3);
  for (int i = 0; i < 5; ++i) mounting.add(road);
  EXPECT_EQ(mounting.likelihoodOf(road), 1);
  EXPECT_EQ(mounting.likelihoodOf({Eigen::Vector3d(0.04, 1, 0).normalized(), 1.55}), 1) << "a banked road";
  for (const GroundPlane& other : {low, tilted}) {
    EXPECT_LT(mounting.likelihoodOf(other), 0.5);
    EXPECT_GT(mounting.likelihoodOf(other), 0.01) << "heavy tails: a ramp is possible";
  }
}

/// Another rig, or a load: the old planes leave.
TEST(CameraMounting, FollowsAChangeThatStays) {
  CameraMounting mounting(kAssumed);
  for (int i = 0; i < 1000; ++i) mounting.add({{0, 1, 0}, 1.6});
  for (int i = 0; i < 200; ++i) mounting.add({{0, 1, 0}, 1.2});
  EXPECT_NEAR(mounting.plane().height_m, 1.2, 1e-9);
}

TEST(LevelAxes, TakeTheRoadToBeLevel) {
  const Eigen::Vector3d normal_cam = expSO3({0.25, 0, 0.05}) * Eigen::Vector3d::UnitY();
  const Eigen::Matrix3d R_cam_level = levelAxes(normal_cam);
  EXPECT_THAT(R_cam_level.col(1), test::IsNear(normal_cam, 1e-12));
  EXPECT_THAT(R_cam_level * R_cam_level.transpose(), test::IsNear(Eigen::Matrix3d::Identity(), 1e-12));
  EXPECT_NEAR(R_cam_level.determinant(), 1, 1e-12);
  EXPECT_NEAR(R_cam_level(0, 2), 0, 0.02) << "ahead is where the camera looks";
  EXPECT_THAT(levelAxes({0, 1, 0}), test::IsNear(Eigen::Matrix3d::Identity(), 0.0));
}

}  // namespace
}  // namespace motorcade
