#include "apps/evaluate/measures/mask_measures.hpp"

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/images/mask_image.hpp"
#include "tests/apps/evaluate/compared_frame_by_hand.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

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
