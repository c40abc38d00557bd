#include "apps/evaluate/measures/box_measures.hpp"

#include <gtest/gtest.h>

#include "tests/apps/evaluate/compared_frame_by_hand.hpp"

namespace motorcade {
namespace {

/// A label ahead, and a row whose cuboid has its size, lies `aside_m` beside it and is turned by `turn_rad`.
ComparedFrame frameWith(double range_m, double aside_m, double turn_rad) {
  ComparedFrame frame;
  frame.objects = {test::labelByHand(7, range_m)};
  frame.rows = {test::rowByHand(3, 0, range_m, aside_m, turn_rad)};
  frame.rows[0].row.object.box = {100, 100, 150, 150};
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

/// A row whose length, width and height are off by the errors in units of their standard deviations.
ComparedFrame frameWithSizeErrors(const Eigen::Vector3d& in_sigmas) {
  ComparedFrame frame = frameWith(20, 0, 0);
  ObjectBox& cuboid = *frame.rows[0].row.object.cuboid;
  cuboid.size_sigma_m = {0.4, 0.1, 0.2};
  cuboid.size_m += in_sigmas.cwiseProduct(cuboid.size_sigma_m);
  return frame;
}

TEST(BoxErrors, TellHowManySizesLieWithinTwoStandardDeviations) {
  const BoxErrors errors =
      boxErrors({frameWithSizeErrors({1.9, -1.9, 2.1}), frameWithSizeErrors({-2.1, 0, -2.1})}, 0, 30);
  EXPECT_NEAR(errors.size_within_2_sigma.x(), 0.5, 1e-12);
  EXPECT_NEAR(errors.size_within_2_sigma.y(), 1, 1e-12);
  EXPECT_NEAR(errors.size_within_2_sigma.z(), 0, 1e-12);
  EXPECT_TRUE((boxErrors({}, 0, 30).size_within_2_sigma == 0).all());
}

}  // namespace
}  // namespace motorcade
