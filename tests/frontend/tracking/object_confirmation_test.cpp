#include "frontend/tracking/object_confirmation.hpp"

#include <gtest/gtest.h>

#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

/// An object whose points lie around a height over a level road 1.65 m below the camera.
struct Walker {
  double height_m = 1, speed_mps = 1.4, sigma_mps = 0.35, traveled_m = 0.6;
  int observations = 4;

  bool isConfirmed() const {
    TrackedObject object;
    object.T_cam_body = SE3(Eigen::Matrix3d::Identity(), {0, GroundPlane{}.height_m - height_m, 12});
    Vector6d twist = Vector6d::Zero();
    twist[0] = speed_mps;
    object.kinematics = ObjectKinematics(object.T_cam_body, twist, sigma_mps * sigma_mps * Matrix12d::Identity());
    object.spawned_at_world = object.T_cam_body.translation() - Eigen::Vector3d(traveled_m, 0, 0);
    for (const double y : {-0.25, 0.25})
      for (const double x : {-0.15, 0.15})
        object.points.push_back({{std::ssize(object.points)}, {x, y, 0}, Eigen::Matrix3d::Identity()});
    for (int i = 1; i < observations; ++i) object.life.observe();
    object.backlog.emplace_back();
    object.backlog.back().box = {600, 150, 630, 200};
    return ObjectConfirmation({}, kRig)(object, {}, GroundPlane{});
  }
};

TEST(ObjectConfirmation, APersonIsKnownByTheWayGone) {
  EXPECT_TRUE(Walker{}.isConfirmed());
  EXPECT_FALSE(Walker{.traveled_m = 0.4}.isConfirmed());
  EXPECT_FALSE(Walker{.observations = 3}.isConfirmed());
  EXPECT_FALSE(Walker{.sigma_mps = 0.5}.isConfirmed()) << "less than three standard deviations of speed";
}

TEST(ObjectConfirmation, APersonWalksOnTheGround) {
  EXPECT_FALSE(Walker{.height_m = 2.2}.isConfirmed());
  EXPECT_TRUE((Walker{.height_m = 2.2, .sigma_mps = 0.1}.isConfirmed())) << "a sure speed needs no such proof";
}

}  // namespace
}  // namespace motorcade
