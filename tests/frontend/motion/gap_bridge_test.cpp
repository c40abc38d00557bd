#include "frontend/motion/gap_bridge.hpp"

#include <gtest/gtest.h>

#include "tests/frontend/motion/wall_with_points.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::kSmallRig;

const SE3 kPredicted(Eigen::Matrix3d::Identity(), {0, 0, 9});
const SE3 kTrue = SE3::exp((Vector6d() << 0.1, 0.05, 7.4, 0.01, 0.12, 0).finished());

TEST(GapBridge, LocatesTheCameraAfterASecondWithoutImagesAndFindsThePointsAgain) {
  const test::WallWithPoints wall(5);
  const auto points = wall.points();
  const auto then = wall.seenFrom(SE3{}, 0), now = wall.seenFrom(kTrue, 1);
  const GapBridge bridge({}, kSmallRig);
  const GapBridge::Gap gap{.points = points, .then = *then, .now = *now, .duration_s = 1};
  const auto found = bridge.locate(gap, kPredicted);
  ASSERT_TRUE(found);
  EXPECT_THAT(*found, test::IsNearPose(kTrue, 0.05));

  const auto observations = bridge.find(gap, *found);
  EXPECT_GT(observations.size(), points.size() / 4);  // of the others, most are out of view
  for (const FlowObservation& o : observations) {
    const auto& point = points[static_cast<std::size_t>(o.point.value)];
    const auto expected_px = kSmallRig.project(kTrue.inverse() * point.p_cam);
    EXPECT_NEAR(o.u_px, expected_px->x(), 0.7);
    EXPECT_NEAR(o.v_px, expected_px->y(), 0.7);
    EXPECT_EQ(o.age, point.observations + 1);
  }
}

/// A wrong answer would be a silent jump.
TEST(GapBridge, DoesNotLocateTheCameraBeforeAnotherWall) {
  for (unsigned seed = 6; seed < 12; ++seed) {
    const test::WallWithPoints wall(seed), other(seed + 100);
    const auto points = wall.points();
    const auto then = wall.seenFrom(SE3{}, 0), now = other.seenFrom(kTrue, 1);
    const GapBridge bridge({}, kSmallRig);
    EXPECT_FALSE(bridge.locate({.points = points, .then = *then, .now = *now, .duration_s = 1}, kPredicted)) << seed;
  }
}

}  // namespace
}  // namespace motorcade
