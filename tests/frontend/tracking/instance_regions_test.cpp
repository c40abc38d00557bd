#include "frontend/tracking/instance_regions.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

constexpr int kLabelsWidth_px = 97, kLabelsHeight_px = 41;

/// Rectangles of a few labels over each other, and single pixels beside them.
InstanceLabels randomLabels(std::uint64_t seed) {
  constexpr int kRectangles = 25, kPixels = 40;
  constexpr std::uint16_t kLabels[] = {0, 3, 7, 12, 500, 65535};
  test::Noise noise(seed);
  InstanceLabels labels(kLabelsWidth_px, kLabelsHeight_px);
  for (int i = 0; i < kRectangles + kPixels; ++i) {
    const int left = noise.below(kLabelsWidth_px), top = noise.below(kLabelsHeight_px);
    const int width = i < kRectangles ? 1 + noise.below(20) : 1, height = i < kRectangles ? 1 + noise.below(12) : 1;
    const std::uint16_t label = kLabels[noise.below(6)];
    for (int v = top; v < std::min(top + height, kLabelsHeight_px); ++v)
      std::fill_n(labels.mutableRow(v) + left, std::min(width, kLabelsWidth_px - left), label);
  }
  return labels;
}

/// Box of a label, by going through all pixels.
Box boxByPixels(const InstanceLabels& labels, std::uint16_t label) {
  Box box{kLabelsWidth_px, kLabelsHeight_px, -1, -1};
  for (int v = 0; v < kLabelsHeight_px; ++v)
    for (int u = 0; u < kLabelsWidth_px; ++u) {
      if (labels.row(v)[u] != label) continue;
      box.left_px = std::min<double>(box.left_px, u), box.right_px = std::max<double>(box.right_px, u);
      box.top_px = std::min<double>(box.top_px, v), box.bottom_px = std::max<double>(box.bottom_px, v);
    }
  return box;
}

TEST(InstanceRegions, AreTheBoxesAroundTheLabelsInTheirOrder) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const InstanceLabels labels = randomLabels(seed);
    std::set<std::uint16_t> there;
    for (int v = 0; v < kLabelsHeight_px; ++v) there.insert(labels.row(v), labels.row(v) + kLabelsWidth_px);
    there.erase(0);
    const std::vector<InstanceRegion> regions = regionsOf(labels);
    ASSERT_EQ(regions.size(), there.size());
    auto expected = there.begin();
    for (const InstanceRegion& region : regions) {
      EXPECT_EQ(region.label, *expected++);
      const Box box = boxByPixels(labels, region.label);
      EXPECT_EQ(region.box.left_px, box.left_px);
      EXPECT_EQ(region.box.top_px, box.top_px);
      EXPECT_EQ(region.box.right_px, box.right_px);
      EXPECT_EQ(region.box.bottom_px, box.bottom_px);
    }
  }
}

TEST(InstanceRegions, OfOnePixelIsThatPixel) {
  InstanceLabels labels(kLabelsWidth_px, kLabelsHeight_px);
  labels.mutableRow(kLabelsHeight_px - 1)[kLabelsWidth_px - 1] = 9;
  const std::vector<InstanceRegion> regions = regionsOf(labels);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions[0].box.left_px, kLabelsWidth_px - 1);
  EXPECT_EQ(regions[0].box.right_px, kLabelsWidth_px - 1);
  EXPECT_EQ(regions[0].box.top_px, kLabelsHeight_px - 1);
  EXPECT_EQ(regions[0].box.bottom_px, kLabelsHeight_px - 1);
}

TEST(InstanceRegions, NoneIsWhereNothingIsTold) {
  EXPECT_TRUE(regionsOf(InstanceLabels(kLabelsWidth_px, kLabelsHeight_px)).empty());
  EXPECT_TRUE(regionsOf(InstanceLabels()).empty());
}

}  // namespace
}  // namespace motorcade
