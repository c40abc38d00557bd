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

}  // namespace
}  // namespace motorcade
