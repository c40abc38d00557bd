#include "frontend/tracking/trunk_windows.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/tracking/labelled_street.hpp"

namespace motorcade {
namespace {

using test::kNarrowRig;
using test::LabelledStreet;

std::vector<TrunkWindow> windowsIn(const SceneMotion& scene, const LabelledStreet& street,
                                   std::vector<bool> on_objects = {}) {
  on_objects.resize(scene.points.size());
  const RegionFlow flow(street.past, kNarrowRig);
  return TrunkWindows(flow, kNarrowRig)(scene, on_objects, LabelledStreet::T_world_cam());
}
std::vector<TrunkWindow> windowsAt(const Eigen::Vector3d& point_px, const LabelledStreet& street) {
  return windowsIn(*street.withoutLabels({point_px}), street);
}

TEST(TrunkWindows, ShowTrunkAndHeadOfWhoWalks) {
  const LabelledStreet street({.walk_mps = 1.4});
  const Box board = street.boardBox();
  const double px_per_m = street.onBoard_px(0, 0).z() / kNarrowRig.baseline_m;
  for (const double right_m : {-0.2, 0.0, 0.2}) {
    const auto windows = windowsAt(street.onBoard_px(right_m, -0.3), street);
    ASSERT_EQ(windows.size(), 1U) << right_m;
    const Box& box = windows[0].box;
    EXPECT_NEAR(box.right_px - box.left_px, 0.6 * px_per_m, 0.05);  // the board turns against the camera
    EXPECT_NEAR(box.top_px, board.bottom_px - 1.8 * px_per_m, 1.5);
    EXPECT_NEAR(box.bottom_px, board.bottom_px - 0.7 * px_per_m, 1.5);
    EXPECT_LT(std::abs(box.left_px - board.left_px), 0.25 * px_per_m) << right_m;
    EXPECT_NEAR(windows[0].pixels.middle_px.x(), street.onBoard_px(0, 0).x(), 0.15 * px_per_m);
  }
}

TEST(TrunkWindows, OfSomebodyAreOne) {
  const LabelledStreet street({.walk_mps = 1.4});
  const auto scene = street.withoutLabels({street.onBoard_px(-0.1, -0.4), street.onBoard_px(0.1, 0)});
  const auto windows = windowsIn(*scene, street);
  ASSERT_EQ(windows.size(), 1U);
  EXPECT_EQ(windows[0].point, 0);
}

TEST(TrunkWindows, AreNotWhereItLooksAsAtRest) {
  const LabelledStreet street({.walk_mps = 0});
  EXPECT_TRUE(windowsAt(street.onBoard_px(0, -0.3), street).empty());
}

TEST(TrunkWindows, AreNotAmidASurface) {
  const LabelledStreet walks({.walk_mps = 1.4}), wide({.walk_mps = 1.4, .width_m = 1.9});
  EXPECT_TRUE(windowsAt(LabelledStreet::onWall_px(-2, 0), walks).empty());
  EXPECT_TRUE(windowsAt(wide.onBoard_px(0, -0.3), wide).empty()) << "as a car or a house in the rain";
}

TEST(TrunkWindows, AreNotAroundPointsThatTellNothing) {
  const LabelledStreet street({.walk_mps = 1.4});
  const auto scene = street.withoutLabels({street.onBoard_px(0, -0.3)});
  EXPECT_EQ(windowsIn(*scene, street).size(), 1U);
  EXPECT_TRUE(windowsIn(*scene, street, {true}).empty()) << "on a known object";
  const ScenePoint point = scene->points[0];
  scene->points[0].ego_inlier = true;
  EXPECT_TRUE(windowsIn(*scene, street).empty()) << "at rest";
  scene->points[0] = point;
  scene->points[0].age = 1;
  EXPECT_TRUE(windowsIn(*scene, street).empty()) << "new";
  scene->points[0] = point;
  scene->points[0].ambiguous = true;
  EXPECT_TRUE(windowsIn(*scene, street).empty()) << "also found where it would be at rest";
  scene->points[0] = point;
  scene->points[0].label = PointLabel::kGround;
  EXPECT_TRUE(windowsIn(*scene, street).empty()) << "on the road";
  scene->points[0] = point;
  scene->points[0].instance = 3;
  EXPECT_TRUE(windowsIn(*scene, street).empty()) << "on what a label shows";
}

TEST(TrunkWindows, AreBetweenKneeAndHead) {
  const LabelledStreet street({.walk_mps = 1.4, .height_m = 2.2});
  const auto at_height = [&](double height_m) {
    return windowsAt(street.onBoard_px(0, 1.1 - height_m), street).size();
  };
  EXPECT_EQ(at_height(0.4), 0U);
  EXPECT_EQ(at_height(1.0), 1U);
  EXPECT_EQ(at_height(1.9), 0U);
}

}  // namespace
}  // namespace motorcade
