#include <random>

#include <gtest/gtest.h>

#include "apps/run/object_view_writer.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

constexpr int kWidth_px = 61, kHeight_px = 43;

Gray16Image emptyMask() { return {kWidth_px, kHeight_px, std::vector<std::uint16_t>(kWidth_px * kHeight_px, 0)}; }

void fill(Gray16Image& mask, int left, int top, int right, int bottom, int value) {
  for (int v = top; v < bottom; ++v)
    for (int u = left; u < right; ++u) mask.pixels[v * mask.width + u] = static_cast<std::uint16_t>(value);
}

class PackedMasks : public testing::Test {
 protected:
  std::vector<std::uint16_t> unpacked(const std::string& png) {
    return readPng16(folder_.write("mask.png", png)).pixels;
  }

  test::TemporaryFolder folder_;
  MaskPacker pack_{kWidth_px, kHeight_px};
};

TEST_F(PackedMasks, ComeBackFromLibpngBitForBit) {
  Gray16Image boxes = emptyMask(), first_row = emptyMask(), noise = emptyMask();
  fill(boxes, 4, 8, 20, 24, 7);
  fill(boxes, 16, 20, 61, 43, 700);  // with an upper byte, down to the corner
  fill(first_row, 0, 0, 61, 9, 65535);
  std::mt19937 random(5);
  for (auto& value : noise.pixels) value = static_cast<std::uint16_t>(random());
  for (const Gray16Image& mask : {emptyMask(), boxes, first_row, noise, boxes})
    EXPECT_EQ(unpacked(pack_(mask)), mask.pixels);
}

TEST_F(PackedMasks, OfAnyHeightComeBack) {
  for (int height = 1; height <= 20; ++height) {
    Gray16Image mask{kWidth_px, height + 16, {}};
    mask.pixels.assign(static_cast<std::size_t>(kWidth_px) * mask.height, 0);
    fill(mask, 3, 5, 9, 5 + height, 2);
    EXPECT_EQ(unpacked(MaskPacker(kWidth_px, mask.height)(mask)), mask.pixels) << height;
  }
}

TEST_F(PackedMasks, AreAsSmallAsThoseOfLibpng) {
  Gray16Image mask{1242, 375, std::vector<std::uint16_t>(1242 * 375, 0)};
  for (int row = 0; row < 30; ++row) fill(mask, 600 - 3 * row, 180 + 4 * row, 700 + 2 * row, 184 + 4 * row, 5);
  writePng16(folder_ / "libpng.png", mask);
  const std::string png = MaskPacker(1242, 375)(mask);
  EXPECT_EQ(unpacked(png), mask.pixels);
  EXPECT_LT(png.size(), 1.2 * static_cast<double>(std::filesystem::file_size(folder_ / "libpng.png")));
}

}  // namespace
}  // namespace motorcade
