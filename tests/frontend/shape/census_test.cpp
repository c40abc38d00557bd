#include "frontend/shape/census.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kCensusWidth_px = 90, kCensusHeight_px = 20;

Image texturedImage() {
  const test::Texture texture(4);
  return test::render(kCensusWidth_px, kCensusHeight_px, [&](double u, double v) { return texture(u, v); });
}

std::uint8_t pixelAt(const Image& image, int u, int v) {
  return image.at(std::clamp(u, 0, kCensusWidth_px - 1), std::clamp(v, 0, kCensusHeight_px - 1));
}

/// Windows in the corner of the image, in its middle and over all of it.
class CensusOfWindow : public testing::TestWithParam<PixelWindow> {};

TEST_P(CensusOfWindow, SaysWhichPixelsAroundAreDarker) {
  const Image image = texturedImage();
  const PixelWindow window = GetParam();
  Census census;
  census.compute(image, window, 0);
  for (int row = 0; row < window.height; ++row)
    for (int column = 0; column < window.width; ++column) {
      const int u = window.u0 + column, v = window.v0 + row;
      int bit = 0, least = 255, most = 0;
      for (int dv = -2; dv <= 2; ++dv)
        for (int du = -2; du <= 2; ++du) {
          const std::uint8_t around = pixelAt(image, u + du, v + dv);
          if (du % 2 == 0 && dv % 2 == 0) least = std::min<int>(least, around), most = std::max<int>(most, around);
          if (du == 0 && dv == 0) continue;
          const bool darker = census.row(bit / 8, row)[column] >> bit % 8 & 1;
          ASSERT_EQ(darker, around < image.at(u, v)) << u << " " << v << " " << du << " " << dv;
          ++bit;
        }
      ASSERT_EQ(census.texture(row)[column], most - least) << u << " " << v;
    }
}

INSTANTIATE_TEST_SUITE_P(Windows, CensusOfWindow,
                         testing::Values(PixelWindow{0, 0, 10, 5}, PixelWindow{30, 8, 40, 4},
                                         PixelWindow{0, 0, kCensusWidth_px, kCensusHeight_px}));

}  // namespace
}  // namespace motorcade
