#include "frontend/tracking/object_association.hpp"

#include <gtest/gtest.h>

#include "core/se3.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

constexpr double kDepth_m = 15;

/// Objects and components side by side across the road, all driving straight ahead at 10 m/s.
struct Road {
  std::vector<TrackedObject> objects;
  SceneMotion scene;
  int next_point = 0;

  /// Adds an object with points of its own: `points` ids from `first`.
  void addObject(double x_m, int first, int points) {
    Eigen::Matrix3d upright;  // columns: ahead = camera's z, left = -x, up = -y
    upright << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    Vector6d twist;
    twist << 10, 0, 0, 0, 0, 0;
    TrackedObject object;
    object.track = {static_cast<std::int64_t>(objects.size())};
    object.kinematics = ObjectKinematics(SE3(upright, {x_m, 1, kDepth_m}), twist, 0.01 * Matrix12d::Identity());
    for (int i = 0; i < points; ++i)
      object.points.push_back({{first + i}, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()});
    objects.push_back(object);
  }
  /// Adds a component of the next `points` ids of the scene.
  void addSegment(double x_m, int points, double speed_mps = 10, PointLabel label = PointLabel::kMoving) {
    MotionComponent component{
        .points = {}, .label = label, .centroid_cam = {x_m, 1, kDepth_m}, .velocity_mps = {0, 0, speed_mps}};
    component.velocity_covariance = 0.04 * Eigen::Matrix3d::Identity();
    for (int i = 0; i < points; ++i) {
      component.points.push_back(static_cast<int>(scene.points.size()));
      scene.points.push_back(
          {.point = {next_point++}, .uvd_px = {600, 200, 25}, .sigma_px = {0.3, 0.3, 0.3}, .flow = {}});
    }
    scene.components.push_back(component);
  }
  std::vector<int> associate() const { return associateObjects(objects, scene, SE3{}, test::kRig); }
};

TEST(ObjectAssociation, TakesTheLeastTotalCostRatherThanTheNearest) {
  Road road;
  road.addObject(0, 1000, 5);
  road.addObject(3, 2000, 5);
  road.addSegment(1.4, 5);   // nearer to object 0 ...
  road.addSegment(-2.5, 5);  // ... which is the only one within reach here
  EXPECT_EQ(road.associate(), (std::vector<int>{1, 0}));
}

TEST(ObjectAssociation, FarAndDifferentSegmentsAreNew) {
  Road road;
  road.addObject(0, 1000, 5);
  road.addSegment(12, 5);
  road.addSegment(0.3, 5, -5);  // at its position, but oncoming
  EXPECT_EQ(road.associate(), (std::vector<int>{-1, -1}));
}

TEST(ObjectAssociation, OnlyMovingSegmentsAreGiven) {
  Road road;
  road.addObject(0, 1000, 5);
  road.addSegment(0, 5, 10, PointLabel::kUnknown);
  EXPECT_EQ(road.associate(), std::vector<int>{-1});
}

TEST(ObjectAssociation, SegmentsOfAnObjectsPointsAreAllGivenToIt) {
  Road road;
  road.addObject(0, 0, 10);  // holds the points of the first two components
  road.addObject(9, 1000, 5);
  road.addSegment(-0.8, 5);
  road.addSegment(0.9, 5);
  road.addSegment(9.2, 5);
  EXPECT_EQ(road.associate(), (std::vector<int>{0, 0, 1}));
}

TEST(ObjectAssociation, SharedPointsOutweighDistance) {
  Road road;
  road.addObject(0, 0, 5);
  road.addObject(2.5, 1000, 5);
  road.addSegment(2.2, 5);  // close to object 1, but made of object 0's points
  EXPECT_EQ(road.associate(), std::vector<int>{0});
}

TEST(ObjectAssociation, NothingToMatchGivesNothing) {
  Road road;
  EXPECT_TRUE(road.associate().empty());
  road.addSegment(0, 3);
  EXPECT_EQ(road.associate(), std::vector<int>{-1});
}

TEST(ObjectAssociation, SharedPointsAreAShareOfTheSegment) {
  Road road;
  road.addObject(0, 2, 10);
  road.addSegment(0, 8);  // points 0..7, of which the object holds 2..7
  EXPECT_DOUBLE_EQ(sharedPoints(road.objects[0], road.scene, road.scene.components[0]), 0.75);
}

}  // namespace
}  // namespace motorcade
