#include "frontend/tracking/see_through.hpp"

#include <gtest/gtest.h>

#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

constexpr double kDepth_m = 10;

/// Two bodies with points at both sides of a gap of two meters, and what is seen in it.
class Gap {
 public:
  Gap() {
    addBody(-1.5, 1.4);
    addBody(1.5, 1.4);
    segment_.points = pointsOf(objects[1]);
  }
  /// Points in the gap, one behind the other.
  void see(int points, double depth_m, PointLabel label = PointLabel::kStatic) {
    for (int i = 0; i < points; ++i) {
      const double aside = (i + 0.5) / points - 0.5;  // of the depth at which the gap is one meter to each side
      addPoint({aside * depth_m / kDepth_m, 0.3, depth_m}).label = label;
    }
  }
  bool areApart() const { return SeeThrough(scene, kRig).areApart(objects[0], objects[1]); }
  bool isGapBetween() const { return SeeThrough(scene, kRig).isGapBetween(objects[0], objects[1]); }
  bool isApart() const { return SeeThrough(scene, kRig).isApart(objects[0], segment_); }

  SceneMotion scene;
  std::vector<TrackedObject> objects;

 private:
  ScenePoint& addPoint(const Eigen::Vector3d& p_cam) {
    ScenePoint& point = scene.points.emplace_back();
    point.point = {std::ssize(scene.points)};
    point.uvd_px = *kRig.project(p_cam);
    return point;
  }
  void addBody(double x_m, double speed_mps) {
    TrackedObject& object = objects.emplace_back();
    object.T_cam_body = SE3(Eigen::Matrix3d::Identity(), {x_m, 0, kDepth_m});
    Vector6d twist = Vector6d::Zero();
    twist[0] = speed_mps;
    object.kinematics = ObjectKinematics(object.T_cam_body, twist, 0.01 * Matrix12d::Identity());
    for (const double x : {-0.3, 0.3})
      for (const double y : {-0.5, 1.0}) {
        const ScenePoint& seen = addPoint({x_m + x, y, kDepth_m});
        object.points.push_back({seen.point, {x, y, 0}, Eigen::Matrix3d::Identity()});
      }
  }
  std::vector<int> pointsOf(const TrackedObject& object) const {
    std::vector<int> points;
    for (std::size_t i = 0; i < scene.points.size(); ++i)
      if (object.find(scene.points[i].point)) points.push_back(static_cast<int>(i));
    return points;
  }
  MotionComponent segment_;
};

TEST(SeeThrough, PeopleBetweenWhomAWallIsSeenAreTwo) {
  Gap gap;
  EXPECT_FALSE(gap.areApart()) << "nothing is known of what is between them";
  gap.see(5, 15);
  EXPECT_TRUE(gap.areApart());
  EXPECT_TRUE(gap.isApart());
}

TEST(SeeThrough, WhatIsBetweenPlacesOfOneBodyIsItsSurface) {
  Gap gap;
  gap.see(5, kDepth_m);
  gap.see(3, 15);
  EXPECT_FALSE(gap.areApart()) << "a wall in the windows";
  EXPECT_FALSE(gap.isApart());
}

TEST(SeeThrough, TheRoadBeneathTellsNothing) {
  Gap gap;
  gap.see(5, kDepth_m, PointLabel::kGround);
  EXPECT_FALSE(gap.areApart());
  gap.see(4, 15);
  EXPECT_TRUE(gap.areApart());
}

/// The second body as a flank that runs away from the camera: above its far end the house behind is seen, although a
/// body as high as its front would hide it.
TEST(SeeThrough, WhatIsSeenAboveTheFarEndIsNotBetween) {
  Gap gap;
  for (ScenePoint& point : gap.scene.points)
    if (gap.objects[1].find(point.point)) point.uvd_px.y() = kRig.cy_px + 0.2 * (point.uvd_px.y() - kRig.cy_px);
  gap.see(5, 15);
  for (ScenePoint& point : gap.scene.points)
    if (point.uvd_px.z() < 0.8 * gap.scene.points.front().uvd_px.z()) point.uvd_px.y() = kRig.cy_px - 33;
  EXPECT_FALSE(gap.isGapBetween());
  for (ScenePoint& point : gap.scene.points)
    if (point.uvd_px.z() < 0.8 * gap.scene.points.front().uvd_px.z()) point.uvd_px.y() = kRig.cy_px;
  EXPECT_TRUE(gap.isGapBetween());
}

TEST(SeeThrough, FewPointsMayHaveWrongDisparities) {
  Gap gap;
  gap.see(2, 15);
  EXPECT_FALSE(gap.areApart());
}

TEST(SeeThrough, OneSeesThroughTheWindowsOfCars) {
  Gap gap;
  gap.see(5, 15);
  Vector6d twist = Vector6d::Zero();
  twist[0] = 10;
  gap.objects[0].kinematics = ObjectKinematics(gap.objects[0].T_cam_body, twist, 0.01 * Matrix12d::Identity());
  EXPECT_FALSE(gap.areApart());
  EXPECT_FALSE(gap.isApart());
  EXPECT_TRUE(gap.isGapBetween()) << "whatever they are";
}

}  // namespace
}  // namespace motorcade
