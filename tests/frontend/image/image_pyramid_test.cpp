#include "frontend/image/image_pyramid.hpp"

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

TEST(ImagePyramid, PixelsOfEachLevelLieWhereTheMessageSays) {
  const auto ramp = [](double x, double y) { return 20 + 0.5 * x + 0.75 * y; };
  ImagePool pool;
  const ImagePyramid pyramid = buildPyramid(test::render(161, 131, ramp), 4, pool);
  ASSERT_EQ(pyramid.levels.size(), 4U);
  for (int level = 0; level < 4; ++level) {
    const Image& image = pyramid.levels[level];
    EXPECT_EQ(image.width(), 161 >> level);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        const double over_x = fromLevel(static_cast<float>(x), level), over_y = fromLevel(static_cast<float>(y), level);
        ASSERT_NEAR(image.at(x, y), ramp(over_x, over_y), 0.5 + 0.5 * level + 1e-3);  // each level rounds once
      }
    }
  }
}

TEST(ImagePyramid, LevelCoordinatesInvert) {
  for (int level = 0; level < 4; ++level) EXPECT_FLOAT_EQ(fromLevel(toLevel(123.25F, level), level), 123.25F);
}

TEST(ImagePyramid, StopsBeforeLevelsTooSmallForAPatch) {
  ImagePool pool;
  EXPECT_EQ(buildPyramid(pool.acquire(70, 40), 4, pool).levels.size(), 2U);
}

TEST(ImagePyramid, ReusesBuffersOnceWarm) {
  ImagePool pool;
  const Image image = test::render(128, 96, [](double x, double y) { return x + y; });
  buildPyramid(image, 3, pool);
  const std::size_t made = pool.buffersMade();
  for (int i = 0; i < 5; ++i) buildPyramid(image, 3, pool);
  EXPECT_EQ(pool.buffersMade(), made);
}

}  // namespace
}  // namespace motorcade
