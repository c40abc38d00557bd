#include "frontend/tracking/search_by_projection.hpp"

#include <gtest/gtest.h>

#include "tests/frontend/tracking/textured_board.hpp"

namespace motorcade {
namespace {

using test::kRig;
using test::TexturedBoard;

const SE3 kKnown = TexturedBoard::standingAt(-1, 14), kOther = TexturedBoard::standingAt(-1.1, 15);

struct Board {
  MeasuredPoints measured{TexturedBoard::seenAt(kKnown), TexturedBoard::points(kKnown, 12, 100)};
  TrackedObject body;
  Board() {
    for (const ScenePoint& p : measured.points) body.points.push_back(toBody(p, kKnown, kRig));
  }
  std::vector<ScenePoint> search(const Features& other, const SE3& predicted) const {
    return searchByProjection(body, measured, other, predicted, 0, kRig);
  }
};

TEST(SearchByProjection, FindsABodysPointsNearWhereTheyWerePredicted) {
  const Board board;
  const SE3 predicted = kOther * SE3(Eigen::Matrix3d::Identity(), {0.1, 0.06, -0.04});  // 3 px aside
  const auto found = board.search(*TexturedBoard::seenAt(kOther), predicted);
  ASSERT_GE(found.size(), 10U);
  for (const ScenePoint& p : found) {
    const Eigen::Vector3d truth_px = *kRig.project(kOther * board.body.find(p.point)->p_body);
    EXPECT_LT((p.uvd_px - truth_px).cwiseAbs().maxCoeff(), 0.3) << p.point.value;
  }
}

TEST(SearchByProjection, FindsNothingWhereTheBodyIsNot) {
  const Board board;
  EXPECT_LE(board.search(*TexturedBoard::seenAt(kOther, false), kOther).size(), 1U);
  EXPECT_LE(board.search(*TexturedBoard::seenAt(TexturedBoard::standingAt(-0.2, 15)), kOther).size(), 1U);
}

TEST(SearchByProjection, LeavesOutWhatIsOutsideTheImageOrUnknown) {
  const Board board;
  EXPECT_TRUE(board.search(*TexturedBoard::seenAt(kOther), TexturedBoard::standingAt(-40, 15)).empty());
  const MeasuredPoints none;
  EXPECT_TRUE(searchByProjection(board.body, none, *TexturedBoard::seenAt(kOther), kOther, 0, kRig).empty());
}

TEST(SamplePatches, LieBetweenThePointsAtTheirDepth) {
  Board board;
  // One point beside the board: what lies between it and the board is the wall.
  board.measured.points.push_back(board.measured.points.front());
  board.measured.points.back().uvd_px.x() = kRig.cx_px + 60;
  const auto patches = samplePatches(board.measured, 0);
  ASSERT_GE(patches.size(), 20U);
  const double disparity_px = kRig.fx_px * kRig.baseline_m / kKnown.translation().z();
  for (const ScenePoint& p : patches) {
    EXPECT_FALSE(isFollowed(p.point));
    EXPECT_NEAR(p.uvd_px.z(), disparity_px, 0.8);
    EXPECT_LT(kRig.triangulate(p.uvd_px).x() - kKnown.translation().x(), TexturedBoard::kHalfWidth_m + 0.2);
  }
}

/// A part of the image that holds the board and some of the wall to its left.
const Box kPart{500, 190, 600, 240};
const double kBoard_px = kRig.fx_px * kRig.baseline_m / kKnown.translation().z();

TEST(SamplePatches, OfAPartOfTheImageLieInItAtTheDisparityAskedFor) {
  const double left_edge_px = kRig.project(kKnown * Eigen::Vector3d(0, TexturedBoard::kHalfWidth_m, 0))->x();
  ASSERT_GT(left_edge_px, kPart.left_px - 40);
  const FeaturesPtr features = TexturedBoard::seenAt(kKnown);
  const auto patches = samplePatches(*features, kPart, kBoard_px, 0);
  ASSERT_GE(patches.size(), 40U);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    EXPECT_EQ(patches[i].point.value, -1 - static_cast<std::int64_t>(i));
    EXPECT_NEAR(patches[i].uvd_px.z(), kBoard_px, 0.8);
    EXPECT_GE(patches[i].uvd_px.x(), kPart.left_px);
    EXPECT_LE(patches[i].uvd_px.x(), kPart.right_px);
    EXPECT_GE(patches[i].uvd_px.y(), kPart.top_px);
    EXPECT_LE(patches[i].uvd_px.y(), kPart.bottom_px);
  }
  EXPECT_LE(samplePatches(*features, kPart, kBoard_px + 3, 0).size(), 2U) << "nothing is so near";
}

TEST(SamplePatches, OfALargePartAreFartherApart) {
  const FeaturesPtr features = TexturedBoard::seenAt(kKnown);
  const Box whole{490, 175, 644, 257};
  const auto patches = samplePatches(*features, whole, kBoard_px, 0);
  EXPECT_GE(patches.size(), 40U);
  EXPECT_LE(patches.size(), 96U) << "64 and those on two edges";
}

TEST(SamplePatches, ContainTheOffsetOfTheDisparity) {
  constexpr double kOffset_px = 8;  // more than the search reaches
  const auto patches = samplePatches(*TexturedBoard::seenAt(kKnown), kPart, kBoard_px + kOffset_px, kOffset_px);
  ASSERT_GE(patches.size(), 40U);
  for (const ScenePoint& p : patches) EXPECT_NEAR(p.uvd_px.z(), kBoard_px + kOffset_px, 0.8);
}

}  // namespace
}  // namespace motorcade
