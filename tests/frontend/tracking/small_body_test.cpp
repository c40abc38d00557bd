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

}  // namespace
}  // namespace motorcade
