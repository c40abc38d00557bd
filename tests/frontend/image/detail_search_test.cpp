#include "frontend/image/detail_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kStripWidth_px = 150, kStripHeight_px = 40, kShift_px = 17;
constexpr double kRatio = 0.9;

/// Expected result of the search, from all costs.
std::optional<int> searchAll(const Image& from, int u, int v, const Image& to, int first_u, int last_u) {
  std::vector<std::uint16_t> costs(last_u - first_u + 1);
  windowDifferences({from, u, v, kHalfSizeWindow}, to, first_u, v, costs);
  const auto best = std::ranges::min_element(costs) - costs.begin();
  for (int i = 0; i < std::ssize(costs); ++i)
    if (std::abs(i - best) > 2 && costs[best] > kRatio * costs[i]) return std::nullopt;
  return first_u + static_cast<int>(best);
}

TEST(DetailSearch, DetailIsTheDifferenceFromTheMeanAround) {
  const Image image = test::render(kStripWidth_px, kStripHeight_px, test::Texture(31), {.gain = 2});
  ImagePool pool;
  const Image detail = withDetail(image, pool).detail;
  for (int v = 0; v < kStripHeight_px; ++v) {
    for (int u = 0; u < kStripWidth_px; ++u) {
      double sum = 0;
      for (int i = 0; i < 45; ++i)
        sum += image.at(std::clamp(u + i % 9 - 4, 0, kStripWidth_px - 1),
                        std::clamp(v + i / 9 - 2, 0, kStripHeight_px - 1));
      const double expected = std::clamp(image.at(u, v) - sum / 45 + 128, 0.0, 255.0);
      ASSERT_NEAR(detail.at(u, v), expected, 0.7);  // rounded, with a mean that is exact to 0.2
    }
  }
}

TEST(DetailSearch, FindsWhatAFullSearchFinds) {
  const test::Texture texture(31);
  const auto shifted = [&](double x, double y) { return texture(x + kShift_px, y); };
  ImagePool pool;
  const DetailedImage left = withDetail(test::render(kStripWidth_px, kStripHeight_px, texture, {.noise = 4}), pool),
                      right = withDetail(test::render(kStripWidth_px, kStripHeight_px, shifted,
                                                      {.gain = 0.9, .bias = 10, .noise = 4, .seed = 2}),
                                         pool);
  int searched = 0, same = 0, right_ones = 0;
  for (int v = 2; v < kStripHeight_px - 2; ++v) {
    for (int u = 110; u < kStripWidth_px - 4; u += 3, ++searched) {
      const auto found = searchRow(left, u, v, right, {u - 100, u}, kRatio);
      same += found == searchAll(left.image, u, v, right.image, u - 100, u);
      right_ones += found == u - kShift_px;
    }
  }
  EXPECT_GE(same, 0.97 * searched);  // what the details rule out is hardly ever as good
  EXPECT_GE(right_ones, 0.9 * searched);
}

TEST(DetailSearch, SearchesColumnsInsideTheImageAlone) {
  ImagePool pool;
  const DetailedImage image = withDetail(test::render(kStripWidth_px, kStripHeight_px, test::Texture(31)), pool);
  EXPECT_EQ(searchRow(image, 4, 2, image, {-50, 4}, kRatio), 4);
  EXPECT_EQ(searchRow(image, kStripWidth_px - 5, kStripHeight_px - 3, image, {kStripWidth_px - 5, kStripWidth_px + 50},
                      kRatio),
            kStripWidth_px - 5);
  EXPECT_FALSE(searchRow(image, 20, 20, image, {-50, 3}, kRatio));
}

TEST(DetailSearch, RepeatedTextureIsAmbiguous) {
  // The same every ten pixels, and of less contrast in the other image: of all alike, none fits exactly.
  const auto fence = [](double x, double y) {
    return 128 + 50 * std::sin(x * 0.2 * std::numbers::pi) * std::sin(y * 0.4);
  };
  ImagePool pool;
  const DetailedImage image = withDetail(test::render(kStripWidth_px, kStripHeight_px, fence), pool),
                      other = withDetail(test::render(kStripWidth_px, kStripHeight_px, fence, {.gain = 0.8}), pool);
  EXPECT_FALSE(searchRow(image, 100, 20, other, {20, 100}, kRatio));
}

}  // namespace
}  // namespace motorcade
