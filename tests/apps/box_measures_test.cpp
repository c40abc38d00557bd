#include "apps/evaluate/box_measures.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

/// A label ahead, heading along the camera's z axis, and a row that places a cuboid of its size off by `aside_m`,
/// turned by `turn_rad`.
ComparedFrame frameWith(double range_m, double aside_m, double turn_rad) {
  ComparedFrame frame;
  TrueObject object;
  object.counted = object.moving = object.ever_moves = true;
  object.truth.size_m = {1.5, 2, 4};
  Eigen::Matrix3d ahead;  // columns: x ahead along z, y down, z to the left
  ahead << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  object.truth.T_cam_object = SE3(ahead, {0, 1.6, range_m});
  object.truth.box = {100, 100, 200, 150};
  frame.objects.push_back(object);

  Eigen::Matrix3d upright;
  upright << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  MatchedRow row;
  row.object = 0;
  row.row.object.points = 20;
  row.row.object.box = {100, 100, 150, 150};
  row.row.object.T_world_body = SE3(upright * expSO3({0, 0, turn_rad}), {aside_m, 1.6, range_m});
  ObjectBox cuboid;
  cuboid.center_body = {0, 0, 0.75};
  cuboid.size_m = {4, 2, 1.5};
  row.row.object.cuboid = cuboid;
  frame.rows.push_back(row);
  return frame;
}

TEST(BoxErrors, OfAPerfectCuboidAreNone) {
  const BoxErrors errors = boxErrors({frameWith(20, 0, 0)}, 0, 30);
  EXPECT_EQ(errors.rows_with_cuboid, 1);
  EXPECT_NEAR(errors.iou_bird, 1, 1e-9);
  EXPECT_NEAR(errors.iou_3d, 1, 1e-9);
  EXPECT_NEAR(errors.center_m.mean, 0, 1e-9);
  EXPECT_NEAR(errors.heading_deg.mean, 0, 1e-6);
  EXPECT_NEAR(errors.iou_2d, 0.5, 1e-9);  // half of the label's box
}

TEST(BoxErrors, GrowWithTheDistanceAndTheTurn) {
  const BoxErrors aside = boxErrors({frameWith(20, 0.5, 0)}, 0, 30);
  EXPECT_NEAR(aside.iou_bird, 1.5 / 2.5, 1e-9);
  EXPECT_NEAR(aside.center_m.mean, 0.5, 1e-9);
  const BoxErrors turned = boxErrors({frameWith(20, 0, 0.1)}, 0, 30);
  EXPECT_NEAR(turned.heading_deg.mean, 0.1 * 180 / M_PI, 1e-6);
  EXPECT_LT(turned.iou_bird, 0.95);
  EXPECT_GT(turned.iou_bird, 0.8);
  const BoxErrors back_to_front = boxErrors({frameWith(20, 0, M_PI)}, 0, 30);
  EXPECT_NEAR(back_to_front.heading_deg.mean, 0, 1e-6);
}

TEST(BoxErrors, CountTheRowsOfTheirRangeOnly) {
  EXPECT_EQ(boxErrors({frameWith(20, 0, 0), frameWith(40, 0, 0)}, 0, 30).rows, 1);
  EXPECT_EQ(boxErrors({frameWith(20, 0, 0), frameWith(40, 0, 0)}, 30, 50).rows, 1);
  ComparedFrame without = frameWith(20, 0, 0);
  without.rows[0].row.object.cuboid.reset();
  const BoxErrors errors = boxErrors({without, frameWith(20, 0, 0)}, 0, 30);
  EXPECT_EQ(errors.rows, 2);
  EXPECT_NEAR(errors.iou_bird, 1, 1e-9);  // over the rows that have one
}

TEST(OverlapArea, OfTurnedSquares) {
  const Footprint square{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  Footprint turned;
  for (const Eigen::Vector2d& p : square)
    turned.emplace_back((p.x() - p.y()) / std::sqrt(2), (p.x() + p.y()) / std::sqrt(2));
  EXPECT_NEAR(areaOf(turned), 4, 1e-12);
  EXPECT_NEAR(overlapArea(square, turned), 8 * (std::sqrt(2) - 1), 1e-9);  // a regular octagon
  Footprint far = square;
  for (Eigen::Vector2d& p : far) p.x() += 5;
  EXPECT_EQ(overlapArea(square, far), 0);
}

TEST(IntersectionOverUnion, OfBoxes) {
  EXPECT_NEAR(intersectionOverUnion({0, 0, 10, 10}, {5, 0, 15, 10}), 1.0 / 3, 1e-12);
  EXPECT_EQ(intersectionOverUnion({0, 0, 10, 10}, {20, 0, 30, 10}), 0);
  EXPECT_EQ(intersectionOverUnion({0, 0, 0, 0}, {0, 0, 0, 0}), 0);
}

}  // namespace
}  // namespace motorcade
