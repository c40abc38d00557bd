#include "apps/evaluate/measures/shape_measures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/files/errors.hpp"
#include "io/images/mask_image.hpp"
#include "tests/apps/evaluate/compared_frame_by_hand.hpp"
#include "tests/io/temporary_folder.hpp"

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

using test::labelByHand;
using test::messageOf;
using test::rowByHand;
using testing::HasSubstr;

constexpr double kDistanceTol = 1e-12;  // of sums of distances

struct Rectangle {
  int left, top, width, height;
};

Gray16Image imageOf(const std::vector<std::pair<Rectangle, std::uint16_t>>& rectangles, int width = 64,
                    int height = 48) {
  Gray16Image image{width, height, std::vector<std::uint16_t>(static_cast<std::size_t>(width) * height)};
  for (const auto& [r, value] : rectangles)
    for (int y = r.top; y < r.top + r.height; ++y)
      for (int x = r.left; x < r.left + r.width; ++x) image.pixels[static_cast<std::size_t>(y) * width + x] = value;
  return image;
}

/// Squares of ten pixels, one two pixels to the right of the other, have 36 boundary pixels each. Of the left one, the
/// ten of the left side are 2 px from the other's. The right side's are 0 at the corners, where they meet the other's
/// upper and lower side, 1 next to them and 2 between (14 in all). Of the upper and lower side, one each is 1 px away.
TEST(MaskMeasures, OfShiftedSquares) {
  const Gray16Image a = imageOf({{{20, 20, 10, 10}, 1}}), b = imageOf({{{22, 20, 10, 10}, 5}});
  EXPECT_NEAR(maskIou({&a, 1}, {&b, 5}), 80.0 / 120, 1e-12);
  EXPECT_NEAR(boundaryDistance_px({&a, 1}, {&b, 5}).value(), (20 + 14 + 2) / 36.0, kDistanceTol);
  EXPECT_EQ(maskIou({&a, 1}, {&a, 1}), 1);
  EXPECT_EQ(boundaryDistance_px({&a, 1}, {&a, 1}), 0);
}

/// Ten rows of ten pixels at the left border, against ten rows of twelve. The upper, lower and right side of the first
/// are 10 + 10 + 8 boundary pixels, of which the right side's are 1, 2, ..., 2, 1 px away (14). Those of the second are
/// 12 + 12 + 8: the last two of the upper and lower side are 1 and 2 px away, the right side's 2 px (22).
TEST(MaskMeasures, TheImagesBorderIsNoBoundary) {
  const Gray16Image a = imageOf({{{0, 20, 10, 10}, 1}}), b = imageOf({{{0, 20, 12, 10}, 1}});
  EXPECT_NEAR(boundaryDistance_px({&a, 1}, {&b, 1}).value(), (14 + 22) / (28 + 32.0), kDistanceTol);
}

TEST(MaskMeasures, AnEmptyMaskHasNoBoundary) {
  const Gray16Image a = imageOf({{{20, 20, 10, 10}, 1}});
  EXPECT_EQ(maskIou({&a, 1}, {&a, 2}), 0);
  EXPECT_EQ(maskIou({&a, 3}, {&a, 2}), 0);
  EXPECT_FALSE(boundaryDistance_px({&a, 1}, {&a, 2}));
}

class MaskFiles : public testing::Test {
 protected:
  MaskFiles() {
    for (const char* name : {"masks", "instance"}) std::filesystem::create_directories(folder_ / name);
  }
  void write(const char* name, int frame, const Gray16Image& image) {
    writePng16(maskFile(folder_ / name, {frame}), image);
  }
  /// Labels 0 at 20 m and 4 at 40 m, with rows of the tracks 11 and 12.
  static ComparedFrame frame(int number) {
    ComparedFrame frame;
    frame.frame = {number};
    frame.objects = {labelByHand(0, 20), labelByHand(4, 40)};
    frame.rows = {rowByHand(11, 0, 20), rowByHand(12, 1, 40)};
    return frame;
  }
  test::TemporaryFolder folder_;
};

TEST_F(MaskFiles, ATracksPixelsAreComparedWithItsLabels) {
  for (int i : {0, 1}) write("instance", i, imageOf({{{20, 20, 10, 10}, 1}, {{40, 20, 5, 5}, 5}}));
  write("masks", 0, imageOf({{{22, 20, 10, 10}, 12}, {{40, 20, 5, 5}, 13}}));
  write("masks", 1, imageOf({{{40, 20, 5, 5}, 13}}));  // nothing of track 11
  // The third frame has no files: the run ended before.
  const auto errors = maskErrors({frame(0), frame(1), frame(2)}, folder_ / "masks", folder_ / "instance");
  ASSERT_TRUE(errors);
  EXPECT_EQ(errors->within_30m.rows, 2);
  EXPECT_EQ(errors->within_30m.rows_with_mask, 1);
  EXPECT_NEAR(errors->within_30m.iou, 0.5 * 80 / 120, 1e-12);
  EXPECT_NEAR(errors->within_30m.iou_of_masks, 80.0 / 120, 1e-12);
  EXPECT_NEAR(errors->within_30m.boundary_px.mean, 1, kDistanceTol);
  EXPECT_EQ(errors->from_30_to_50m.rows, 2);
  EXPECT_EQ(errors->from_30_to_50m.iou, 1);
  EXPECT_FALSE(maskErrors({frame(0)}, folder_ / "none", folder_ / "instance"));
}

TEST_F(MaskFiles, OfAnotherSizeOrWithoutTruthAreRefused) {
  write("masks", 0, imageOf({}, 32, 32));
  write("instance", 0, imageOf({}));
  const auto compare = [&] { maskErrors({frame(0)}, folder_ / "masks", folder_ / "instance"); };
  EXPECT_THAT(messageOf<InputError>(compare), HasSubstr("masks/000000.png: is not of the size of"));
  std::filesystem::remove(folder_ / "instance/000000.png");
  EXPECT_THAT(messageOf<InputError>(compare), HasSubstr("instance/000000.png"));
}

}  // namespace
}  // namespace motorcade
