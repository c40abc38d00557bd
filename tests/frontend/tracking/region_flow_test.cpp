#include "frontend/tracking/region_flow.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/tracking/labelled_street.hpp"
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

using test::kNarrowRig;
using test::LabelledStreet;

constexpr double kCertain_chi2 = 100, kUncertain_chi2 = 16;

/// Flow of a box in the newest frame, whose middle is on a surface with this disparity.
std::optional<SceneFlow> flowIn(const Box& labelled, double disparity_px, const LabelledStreet& street) {
  const RegionFlow flow(street.past, kNarrowRig);
  const auto scene = street.now(labelled, {});
  const RegionPixels pixels = pixelsOf(LabelledStreet::region(labelled), *scene->features->frame->inputs.instances);
  const auto seen = flow(pixels, disparity_px, *scene, LabelledStreet::T_world_cam(), 0);
  if (!seen) return std::nullopt;
  EXPECT_NEAR(seen->duration_s, LabelledStreet::kFrame_s * (seen->flow.observations - 1), 1e-9);
  return seen->flow;
}
std::optional<SceneFlow> flowOfBoard(const LabelledStreet& street) {
  return flowIn(street.boardBox(), street.onBoard_px(0, 0).z(), street);
}

double byWhichItMoves(const SceneFlow& flow) { return flow.static_chi2 - flow.moving_chi2; }

void expectVelocity(const SceneFlow& flow, const Eigen::Vector3d& velocity_mps) {
  for (int i = 0; i < 3; ++i)
    EXPECT_LT(std::abs(flow.velocity_mps[i] - velocity_mps[i]), 3 * std::sqrt(flow.covariance(3 + i, 3 + i))) << i;
}

TEST(RegionFlow, IsTheVelocityOfWhoWalksBeforeAWall) {
  for (const unsigned seed : {1U, 2U}) {
    const LabelledStreet street({.walk_mps = 1.4, .seed = seed});
    const auto flow = flowOfBoard(street);
    ASSERT_TRUE(flow) << seed;
    EXPECT_EQ(flow->observations, LabelledStreet::kNow + 1) << seed;
    EXPECT_GT(byWhichItMoves(*flow), kCertain_chi2) << seed;
    expectVelocity(*flow, street.velocity_cam_mps());
    EXPECT_NEAR(flow->velocity_mps.x(), street.velocity_cam_mps().x(), 0.1) << seed;  // 2 px in half a second
    // The trunk is above the middle.
    EXPECT_NEAR(kNarrowRig.project(flow->p_cam)->z(), street.onBoard_px(0, 0).z(), 0.5) << seed;
    EXPECT_NEAR(kNarrowRig.project(flow->p_cam)->x(), street.onBoard_px(0, 0).x(), 2) << seed;
  }
}

TEST(RegionFlow, TellsByBrightnessWhetherTheRegionRests) {
  for (const double walk_mps : {0.0, 1.4}) {
    const LabelledStreet street({.walk_mps = walk_mps});
    const auto scene = street.now(street.boardBox(), {});
    const RegionFlow flow(street.past, kNarrowRig);
    const auto rests = [&](const Box& box, double disparity_px) {
      return flow.rests(pixelsIn(box, 60), disparity_px, *scene, LabelledStreet::T_world_cam());
    };
    const Eigen::Vector3d wall_px = LabelledStreet::onWall_px(-2, 0);
    EXPECT_EQ(rests(street.boardBox(), street.onBoard_px(0, 0).z()), walk_mps == 0);
    EXPECT_TRUE(rests(LabelledStreet::around(wall_px, 0.8, 0.8), wall_px.z()));
    const RegionPixels board = pixelsAtDepth(street.boardBox(), street.onBoard_px(0, 0).z(), *scene);
    const auto seen = flow(board, street.onBoard_px(0, 0).z(), *scene, LabelledStreet::T_world_cam(), 1);
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->flow.observations, LabelledStreet::kNow + 1);
    EXPECT_EQ(seen->not_static_chi2 > kCertain_chi2, walk_mps > 0) << seen->not_static_chi2;
  }
}

TEST(RegionFlow, TakesPixelsThatAreEvenlySpread) {
  const RegionPixels all = pixelsIn({10, 20, 14, 27}, 1000), some = pixelsIn({10, 20, 49, 99}, 60);
  EXPECT_EQ(all.offsets_px.size(), 40U);
  EXPECT_EQ(all.step_px, 1);
  EXPECT_LT((all.middle_px - Eigen::Vector2d(12, 23.5)).norm(), 1e-9);
  EXPECT_EQ(some.step_px, 7);
  EXPECT_EQ(some.offsets_px.size(), 6U * 12U);
}

TEST(RegionFlow, TakesPixelsAtOneDepth) {
  const LabelledStreet street({});
  const auto scene = street.now(street.boardBox(), {});
  const double disparity_px = street.onBoard_px(0, 0).z();
  const Box wide = LabelledStreet::around(street.onBoard_px(0, 0), 0.9, 0.85), board = street.boardBox();
  const RegionPixels pixels = pixelsAtDepth(wide, disparity_px, *scene);
  ASSERT_GT(pixels.offsets_px.size(), 15U);
  constexpr double kPatch_px = 8;  // half a window of a patch, which is at the board's depth where it shows its border
  const auto isOnBoard = [&](const Eigen::Vector2f& offset_px) {
    const double u_px = pixels.middle_px.x() + offset_px.x();
    return u_px > board.left_px - kPatch_px && u_px < board.right_px + kPatch_px;
  };
  const auto on_board = std::ranges::count_if(pixels.offsets_px, isOnBoard);
  EXPECT_GT(static_cast<double>(on_board), 0.9 * static_cast<double>(pixels.offsets_px.size()));
}

TEST(RegionFlow, FindsWhoWalksToTheLeft) {
  const LabelledStreet street({.walk_mps = -1.4, .seed = 3});
  const auto flow = flowOfBoard(street);
  ASSERT_TRUE(flow);
  EXPECT_GT(byWhichItMoves(*flow), kCertain_chi2);
  expectVelocity(*flow, street.velocity_cam_mps());
}

TEST(RegionFlow, WhoStandsIsAtRest) {
  for (const unsigned seed : {1U, 2U}) {
    const LabelledStreet street({.walk_mps = 0, .seed = seed});
    const auto flow = flowOfBoard(street);
    ASSERT_TRUE(flow) << seed;
    EXPECT_LT(byWhichItMoves(*flow), kUncertain_chi2) << seed;
    expectVelocity(*flow, Eigen::Vector3d::Zero());
  }
}

/// The disparity is that of a few points, which may be wrong: with that of the wall, nothing is found on the board.
TEST(RegionFlow, IsEmptyWhereTheDisparityIsWrong) {
  const LabelledStreet street({});
  EXPECT_FALSE(flowIn(street.boardBox(), LabelledStreet::onWall_px(0, 0).z(), street));
}

TEST(RegionFlow, IsEmptyWhereTooFewFramesAreRemembered) {
  LabelledStreet street({});
  const LookBack all = street.past;
  const auto flowWith = [&](std::size_t frames) {
    street.past.forget();
    for (std::size_t i = all.past().size() - frames; i < all.past().size(); ++i)
      street.past.remember(all.past()[i].scene, all.past()[i].T_world_cam, {}, {});
    return flowOfBoard(street);
  };
  EXPECT_FALSE(flowWith(0));
  EXPECT_FALSE(flowWith(1));
  const auto flow = flowWith(2);
  ASSERT_TRUE(flow);
  EXPECT_EQ(flow->observations, 3);
}

TEST(RegionFlow, IsEmptyWhereItIsFoundInTooSmallAShareOfTheFrames) {
  LabelledStreet street({.seed = 1});
  const LookBack all = street.past, others = LabelledStreet({.seed = 2}).past;
  street.past.forget();
  for (std::size_t i = 0; i < all.past().size(); ++i) {
    const auto& past = (i < 3 ? others : all).past()[i];
    street.past.remember(past.scene, past.T_world_cam, {}, {});
  }
  const auto scene = street.now(street.boardBox(), {});
  const double disparity_px = street.onBoard_px(0, 0).z();
  const RegionPixels board = pixelsAtDepth(street.boardBox(), disparity_px, *scene);
  const RegionFlow flow(street.past, kNarrowRig);
  const auto seen = flow(board, disparity_px, *scene, LabelledStreet::T_world_cam(), 0.4);
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->flow.observations, 3) << "two of five frames before, and the newest";
  EXPECT_FALSE(flow(board, disparity_px, *scene, LabelledStreet::T_world_cam(), 0.6));
}

}  // namespace
}  // namespace motorcade
