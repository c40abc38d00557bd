#include "frontend/tracking/region_flow.hpp"

#include <cmath>
#include <cstddef>
#include <optional>

#include <gtest/gtest.h>

#include "tests/frontend/tracking/labelled_street.hpp"

namespace motorcade {
namespace {

using test::kNarrowRig;
using test::LabelledStreet;

constexpr double kCertain_chi2 = 100, kUncertain_chi2 = 16;

/// Flow of a box in the newest frame, whose middle is on a surface with this disparity.
std::optional<SceneFlow> flowIn(const Box& labelled, double disparity_px, const LabelledStreet& street) {
  const RegionFlow flow(street.past, kNarrowRig);
  const auto seen =
      flow(LabelledStreet::region(labelled), disparity_px, *street.now(labelled, {}), LabelledStreet::T_world_cam());
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

}  // namespace
}  // namespace motorcade
