#include "frontend/tracking/small_body.hpp"

#include <gtest/gtest.h>

#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

/// An object with points at the corners of a box on the road.
TrackedObject objectOf(double length_m, double width_m, double speed_mps, double depth_m = 12) {
  TrackedObject object;
  object.T_cam_body = SE3(Eigen::Matrix3d::Identity(), {0, 1, depth_m});
  Vector6d twist = Vector6d::Zero();
  twist[0] = speed_mps;
  object.kinematics = ObjectKinematics(object.T_cam_body, twist, 0.01 * Matrix12d::Identity());
  std::int64_t id = 0;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      for (const double z : {0.0, 1.5})
        object.points.push_back({{id++}, {x * length_m, y * width_m, z}, Eigen::Matrix3d::Identity()});
  return object;
}

TEST(SmallBody, IsThatOfAPersonOrATwoWheeler) {
  EXPECT_TRUE(mayBeSmall(objectOf(0.8, 0.6, 1.4)));
  EXPECT_TRUE(mayBeSmall(objectOf(1.8, 0.6, 6))) << "a bicycle";
  EXPECT_FALSE(mayBeSmall(objectOf(4, 1.7, 1.4))) << "a car in a queue";
  EXPECT_FALSE(mayBeSmall(objectOf(0.8, 0.6, 12))) << "a few points on a car";
}

TEST(SmallBody, OfAWalkerIsNearEnoughToStandOutFromWhatIsBehind) {
  EXPECT_TRUE(mayBeWalking(objectOf(0.8, 0.6, 1.4, 20), kRig));
  EXPECT_FALSE(mayBeWalking(objectOf(0.8, 0.6, 1.4, 30), kRig));
  StereoCamera wide = kRig;
  wide.baseline_m *= 2;
  EXPECT_TRUE(mayBeWalking(objectOf(0.8, 0.6, 1.4, 30), wide)) << "a rig that measures depth better";
}

TEST(SmallBody, OfAWalkerNeitherStandsNorRides) {
  EXPECT_FALSE(mayBeWalking(objectOf(0.8, 0.6, 0.3), kRig));
  EXPECT_FALSE(mayBeWalking(objectOf(0.8, 0.6, 5), kRig));
  EXPECT_FALSE(mayBeWalking(objectOf(4, 1.7, 1.4), kRig));
}

TEST(SmallBody, MayStandOnFootOrHaveBeenSlowerAtItsBirth) {
  EXPECT_TRUE(mayBeOnFoot(objectOf(0.8, 0.6, 0)));
  EXPECT_FALSE(mayBeOnFoot(objectOf(4, 1.7, 0))) << "a parked car";
  TrackedObject fast = objectOf(0.8, 0.6, kFastestWalk_mps + 1);
  EXPECT_FALSE(mayBeOnFoot(fast));
  fast.born_slow = true;
  EXPECT_TRUE(mayBeOnFoot(fast));
}

TEST(SmallBody, OfAWalkerKeepsItsSpeedAndGoesToAnySide) {
  const ObjectKinematics::Params vehicle;
  for (const double speed_mps : {0.0, 1.4, kFastestWalk_mps - 0.1}) {
    const auto walk = kinematicsOf(objectOf(0.8, 0.6, speed_mps), vehicle);
    EXPECT_EQ(walk.acceleration.along_mps2, 0.5);
    EXPECT_EQ(walk.acceleration.sideways_mps2, 0.5);
    EXPECT_EQ(walk.slip_mps, 1);
    EXPECT_EQ(walk.acceleration.yaw_radps2, vehicle.acceleration.yaw_radps2) << "the rest is a vehicle's";
    EXPECT_EQ(walk.tilt_rad, vehicle.tilt_rad);
  }
}

TEST(SmallBody, OfWhoRidesMovesLikeAVehicle) {
  const ObjectKinematics::Params vehicle;
  for (const auto& object : {objectOf(0.8, 0.6, kFastestWalk_mps + 0.1), objectOf(4, 1.7, 1.4)}) {
    const auto kinematics = kinematicsOf(object, vehicle);
    EXPECT_EQ(kinematics.acceleration.along_mps2, vehicle.acceleration.along_mps2);
    EXPECT_EQ(kinematics.acceleration.sideways_mps2, vehicle.acceleration.sideways_mps2);
    EXPECT_EQ(kinematics.slip_mps, vehicle.slip_mps);
  }
}

/// A body that is known by one point, so far below the camera.
TrackedObject knownBy(double right_m, double below_m) {
  TrackedObject object;
  object.points.push_back({{0}, {right_m, below_m, 0.1}, Eigen::Matrix3d::Identity()});
  return object;
}

TEST(SmallBody, HasATrunkAndAHeadAboveTheRoadAroundItsPoints) {
  const GroundPlane ground;
  const SE3 T_cam_body(Eigen::Matrix3d::Identity(), {0.5, 0.2, 12});
  for (const double below_m : {0.2, 1.3}) {  // a shoulder, a foot
    const auto trunk = trunkOf(knownBy(0.2, below_m), T_cam_body, ground, kRig);
    ASSERT_TRUE(trunk);
    const double z_m = 12.1;
    const Eigen::Vector3d head_left = *kRig.project({0.7 - 0.3, ground.height_m - 1.8, z_m}),
                          hip_right = *kRig.project({0.7 + 0.3, ground.height_m - 0.8, z_m});
    EXPECT_NEAR(trunk->box.left_px, head_left.x(), 1e-9);
    EXPECT_NEAR(trunk->box.top_px, head_left.y(), 1e-9);
    EXPECT_NEAR(trunk->box.right_px, hip_right.x(), 1e-9);
    EXPECT_NEAR(trunk->box.bottom_px, hip_right.y(), 1e-9);
    EXPECT_NEAR(trunk->disparity_px, head_left.z(), 1e-9);
  }
}

TEST(SmallBody, StandsUprightOnARoadThatTilts) {
  GroundPlane ground;
  ground.normal_cam = Eigen::Vector3d(0, 1, 0.1).normalized();
  const auto trunk = trunkOf(knownBy(0, 0.5), SE3(Eigen::Matrix3d::Identity(), {0, 0, 12}), ground, kRig);
  ASSERT_TRUE(trunk);
  const Eigen::Vector3d foot = Eigen::Vector3d(0, 0.5, 12.1) + ground.heightOf_m({0, 0.5, 12.1}) * ground.normal_cam;
  EXPECT_NEAR(trunk->box.top_px, kRig.project(foot - 1.8 * ground.normal_cam)->y(), 1e-9);
  EXPECT_NEAR(trunk->box.bottom_px, kRig.project(foot - 0.8 * ground.normal_cam)->y(), 1e-9);
}

TEST(SmallBody, HasNoTrunkBehindTheCamera) {
  EXPECT_FALSE(trunkOf(knownBy(0, 0.5), SE3(Eigen::Matrix3d::Identity(), {0, 0, -1}), {}, kRig));
}

}  // namespace
}  // namespace motorcade
