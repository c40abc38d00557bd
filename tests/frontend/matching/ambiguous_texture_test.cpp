#include "frontend/matching/ambiguous_texture.hpp"

#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr int kTextureWidth_px = 200, kTextureHeight_px = 60;

/// Smooth random columns and rows; the pattern comes back every `period` columns.
Image texture(int period) {
  std::mt19937 random(3);
  std::vector<int> tile(static_cast<std::size_t>(period * kTextureHeight_px));
  for (auto& v : tile) v = static_cast<int>(random() % 200) + 20;
  ImagePool pool;
  Image image = pool.acquire(kTextureWidth_px, kTextureHeight_px);
  const auto at = [&](int x, int y) { return tile[y * period + x % period]; };
  for (int y = 0; y < kTextureHeight_px; ++y) {
    for (int x = 0; x < kTextureWidth_px; ++x) {  // a 2x2 mean, so that the patches have slopes to descend
      const int below = std::min(y + 1, kTextureHeight_px - 1);
      image.mutableRow(y)[x] =
          static_cast<std::uint8_t>((at(x, y) + at(x + 1, y) + at(x, below) + at(x + 1, below)) / 4);
    }
  }
  return image;
}

const Eigen::Vector2d kFollowed{80, 30}, kOnePeriodOn{112, 30};

/// A patch that was followed as if it had not moved in the image.
FollowedPatch followed(const Image& image) { return {image, image, kFollowed, kFollowed}; }

TEST(AmbiguousTexture, FindsAFencePostWhereItsNeighborStood) {
  const Image fence = texture(32);
  EXPECT_TRUE(isAlsoFoundAtRest(followed(fence), kOnePeriodOn + Eigen::Vector2d(1, -1), 1.0));
}

TEST(AmbiguousTexture, FindsNothingWhereAVehicleHidesOtherThings) {
  const Image street = texture(kTextureWidth_px);
  EXPECT_FALSE(isAlsoFoundAtRest(followed(street), kOnePeriodOn, 1.0));
}

TEST(AmbiguousTexture, SaysNothingWhereBothPositionsAreOne) {
  const Image street = texture(kTextureWidth_px);
  EXPECT_FALSE(isAlsoFoundAtRest(followed(street), kFollowed + Eigen::Vector2d(3, 0), 1.0));
}

}  // namespace
}  // namespace motorcade
