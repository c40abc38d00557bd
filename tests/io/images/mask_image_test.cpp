#include "io/images/mask_image.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

ObjectMask maskOf(std::int64_t track, int left_px, int width, int cell_px) {
  return {.track = {track},
          .left_px = left_px,
          .top_px = 4,
          .cell_px = cell_px,
          .width = width,
          .height = 3,
          .inside = std::vector<std::uint8_t>(static_cast<std::size_t>(width) * 3, 1)};
}

ObjectEstimate objectAt(std::int64_t track, double z_m) {
  ObjectEstimate object;
  object.track = {track};
  object.T_world_body = SE3(Eigen::Matrix3d::Identity(), {0, 0, z_m});
  return object;
}

TEST(MaskImage, HasTheTracksNumberPlusOneOfTheNearest) {
  FrameEstimate frame;
  frame.objects = {objectAt(0, 10), objectAt(7, 20)};
  const auto image = maskImage(frame, {maskOf(0, 10, 5, 2), maskOf(7, 16, 5, 2)}, 64, 32);
  const auto at = [&](int u, int v) { return image.pixels[static_cast<std::size_t>(v) * 64 + u]; };
  EXPECT_EQ(at(9, 5), 0);
  EXPECT_EQ(at(10, 4), 1);
  EXPECT_EQ(at(19, 9), 1);  // both: track 0 is nearer
  EXPECT_EQ(at(20, 9), 8);
  EXPECT_EQ(at(25, 9), 8);
  EXPECT_EQ(at(26, 9), 0);
  EXPECT_EQ(at(20, 10), 0);
}

TEST(MaskImage, KnowsItsFilesByName) {
  EXPECT_TRUE(isMaskFile(maskFile("masks", FrameId{12})));
  EXPECT_TRUE(isMaskFile(maskFile("masks", FrameId{12345678})));
  for (const char* other : {"masks/car.png", "masks/000012.txt", "masks/12a456.png", "masks/.png"})
    EXPECT_FALSE(isMaskFile(other)) << other;
}

TEST(MaskImage, KeepsToTheImage) {
  FrameEstimate frame;
  frame.objects = {objectAt(3, 10)};
  const auto image = maskImage(frame, {maskOf(3, -4, 50, 4)}, 20, 8);
  EXPECT_EQ(std::ranges::count(image.pixels, 4), 20 * 4);
}

}  // namespace
}  // namespace motorcade
