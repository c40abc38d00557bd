#include "io/images/bayer.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "io/images/image_file.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/sequence/sequence.hpp"
#include "tests/support/data_folder.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::array kPatterns = {BayerPattern::kRggb, BayerPattern::kBggr, BayerPattern::kGrbg, BayerPattern::kGbrg};

/// Smooth colors with an edge, as lenses show them.
RgbImage scene(int width, int height) {
  RgbImage image{width, height, std::vector<std::uint8_t>(std::size_t{3} * width * height)};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double wave = 40 * std::sin(0.11 * x + 0.05 * y) + (x > width / 2 ? 25 : 0);
      image.at(x, y)[0] = static_cast<std::uint8_t>(150 + wave);
      image.at(x, y)[1] = static_cast<std::uint8_t>(110 + 0.8 * wave + 20 * std::cos(0.07 * y));
      image.at(x, y)[2] = static_cast<std::uint8_t>(60 + 0.5 * wave);
    }
  return image;
}

/// Simulates the mosaic that a sensor with such filters records of an image.
Image mosaicOf(const RgbImage& image, BayerPattern pattern, ImagePool& pool) {
  Image mosaic = pool.acquire(image.width, image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      mosaic.mutableRow(y)[x] =
          image.at(x, y)[std::string_view("RGB").find(nameOf(pattern)[static_cast<std::size_t>(y % 2 * 2 + x % 2)])];
  return mosaic;
}

int lumaAt(const RgbImage& image, int x, int y) {
  const std::uint8_t* pixel = image.at(x, y);
  return grayOf(pixel[0], pixel[1], pixel[2]);
}

class Bayer : public testing::Test {
 protected:
  ImagePool pool_;
};

TEST_F(Bayer, AMosaicGivesNearlyTheGrayOfItsScene) {
  const RgbImage image = scene(97, 64);
  for (const BayerPattern pattern : kPatterns) {
    const Image gray = grayOfMosaic(mosaicOf(image, pattern, pool_), pattern, pool_);
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const bool at_edge = std::abs(x - image.width / 2) < 3;
        EXPECT_NEAR(gray.at(x, y), lumaAt(image, x, y), at_edge ? 40 : 4) << nameOf(pattern) << " " << x << " " << y;
        sum += std::abs(gray.at(x, y) - lumaAt(image, x, y));
      }
    EXPECT_LT(sum / (image.width * image.height), 1.0) << nameOf(pattern);
  }
}

TEST_F(Bayer, ASceneOfOneColorHasItsLumaUpToTheCorners) {
  RgbImage image{18, 17, {}};
  for (int i = 0; i < 18 * 17; ++i) image.pixels.insert(image.pixels.end(), {201, 90, 33});
  for (const BayerPattern pattern : kPatterns) {
    const Image gray = grayOfMosaic(mosaicOf(image, pattern, pool_), pattern, pool_);
    for (int y = 0; y < 17; ++y)
      for (int x = 0; x < 18; ++x) ASSERT_EQ(gray.at(x, y), lumaAt(image, 5, 5)) << nameOf(pattern);
  }
}

/// Compares one bright pixel on black with weights computed by hand from the formula of the source.
TEST_F(Bayer, EachPixelWeighsAsTheFormulaSays) {
  Image mosaic = pool_.acquire(16, 16);
  for (int y = 0; y < 16; ++y) std::fill_n(mosaic.mutableRow(y), 16, std::uint8_t{0});
  mosaic.mutableRow(6)[6] = 240;  // red
  const Image red = grayOfMosaic(mosaic, BayerPattern::kRggb, pool_);
  EXPECT_EQ(red.at(6, 6), 72);  // 240 * 77 / 256 = 72.19
  EXPECT_EQ(red.at(7, 6), 36);  // half of it beside and above, a quarter at the diagonals
  EXPECT_EQ(red.at(6, 5), 36);
  EXPECT_EQ(red.at(5, 5), 18);
  EXPECT_EQ(red.at(8, 6), 0);
  const Image green = grayOfMosaic(mosaic, BayerPattern::kGrbg, pool_);
  EXPECT_EQ(green.at(6, 6), 141);  // 240 * 150 / 256 = 140.6
  EXPECT_EQ(green.at(7, 6), 35);   // a quarter of it beside and above
  EXPECT_EQ(green.at(6, 7), 35);
  EXPECT_EQ(green.at(7, 7), 0);
}

TEST_F(Bayer, PatternsAreKnownByTheirNames) {
  for (const BayerPattern pattern : kPatterns) EXPECT_EQ(bayerPatternOf(nameOf(pattern)), pattern);
  EXPECT_EQ(bayerPatternOf("grbg"), BayerPattern::kGrbg);
  EXPECT_EQ(bayerPatternOf("bayer_bggr8"), BayerPattern::kBggr);
  EXPECT_EQ(bayerPatternOf("bayer_gbrg16"), BayerPattern::kGbrg);
  for (const char* name : {"", "RGB", "RGGBX", "8", "bayer_", "yes"}) EXPECT_FALSE(bayerPatternOf(name)) << name;
}

TEST_F(Bayer, AMosaicIsSuspectedAndItsGrayIsNot) {
  const RgbImage image = scene(96, 64);
  for (const BayerPattern pattern : kPatterns) {
    const Image mosaic = mosaicOf(image, pattern, pool_);
    const auto suspected = suspectedMosaic(mosaic);
    ASSERT_TRUE(suspected);
    EXPECT_NE(suspected->find(nameOf(pattern)), std::string::npos) << *suspected;
    EXPECT_FALSE(suspectedMosaic(grayOfMosaic(mosaic, pattern, pool_)));
  }
}

/// Interlaced images and sensors with two readers differ by whole rows or columns.
TEST_F(Bayer, RowsAndColumnsThatDifferAreNoMosaic) {
  for (const bool rows : {true, false}) {
    Image image = pool_.acquire(64, 48);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) image.mutableRow(y)[x] = static_cast<std::uint8_t>(90 + 12 * ((rows ? y : x) % 2));
    EXPECT_FALSE(suspectedMosaic(image));
  }
}

TEST_F(Bayer, NoRealImageIsSuspected) {
  int looked_at = 0;
  for (const char* name : {"kitti_tracking_0003", "kitti_odometry_04", "kitti_odometry_06", "kitti_tracking_0001",
                           "kitti_1405_cyclist", "rendered_street", "euroc_v101"}) {
    const fs::path drive = test::dataFolder() / name;
    if (!fs::exists(drive)) continue;
    const Sequence sequence = openSequence(drive);
    for (std::size_t i = 0; i < sequence.frames.size(); i += 5, ++looked_at)
      for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight})
        EXPECT_FALSE(suspectedMosaic(readImage(sequence.frames[i].of(side), pool_))) << name << " " << i;
  }
  if (looked_at == 0) GTEST_SKIP() << "no drives in " << test::dataFolder();
}

}  // namespace
}  // namespace motorcade
