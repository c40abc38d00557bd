#include "frontend/motion/coarse_localization.hpp"

#include <gtest/gtest.h>

#include "tests/frontend/motion/wall_with_points.hpp"

namespace motorcade {
namespace {

using test::kSmallRig;

/// Greatest distance between where two motions put points that both show [px].
double farthestApart_px(const std::vector<RestingPoint>& points, const SE3& T_then_a, const SE3& T_then_b) {
  double farthest = 0;
  for (const RestingPoint& p : points) {
    const auto a = kSmallRig.project(T_then_a.inverse() * p.p_cam), b = kSmallRig.project(T_then_b.inverse() * p.p_cam);
    if (!a || !b || !kSmallRig.inLeftImage(a->x(), a->y())) continue;
    farthest = std::max(farthest, (a->head<2>() - b->head<2>()).norm());
  }
  return farthest;
}

TEST(CoarseLocalization, FindsAMotionThatIsFarFromThePredictedOne) {
  const test::WallWithPoints wall(3);
  const auto then = wall.seenFrom(SE3{}, 0);
  for (const double turn_rad : {-0.15, 0.0, 0.2}) {
    const SE3 T_then_now = SE3::exp((Vector6d() << 0, 0, 7.3, 0, turn_rad, 0).finished());
    const auto now = wall.seenFrom(T_then_now, 1);
    const MotionRange range{.T_then_now = SE3(Eigen::Matrix3d::Identity(), {0, 0, 10}), .forward_m = 4, .yaw_rad = 0.3};
    const auto found = localizeCoarsely(wall.points(), then->left, now->left, range, kSmallRig);
    ASSERT_FALSE(found.empty()) << turn_rad;
    EXPECT_LT(farthestApart_px(wall.points(), T_then_now, found.front()), 16) << turn_rad;
  }
}

/// The range is that after two seconds: a quarter of the points choose among its motions.
TEST(CoarseLocalization, FindsAMotionAmongTensOfThousands) {
  const MotionRange range{.T_then_now = SE3(Eigen::Matrix3d::Identity(), {0, 0, 22}), .forward_m = 20, .yaw_rad = 1.0};
  const SE3 T_then_now = SE3::exp((Vector6d() << 0, 0, 9.4, 0.01, -0.25, 0).finished());
  for (unsigned seed = 5; seed < 8; ++seed) {
    const test::WallWithPoints wall(seed);
    const auto then = wall.seenFrom(SE3{}, 0), now = wall.seenFrom(T_then_now, 1);
    const auto found = localizeCoarsely(wall.points(), then->left, now->left, range, kSmallRig);
    ASSERT_FALSE(found.empty()) << seed;
    EXPECT_LT(farthestApart_px(wall.points(), T_then_now, found.front()), 16) << seed;
  }
}

TEST(CoarseLocalization, WithoutPointsThereIsNothingToFind) {
  const test::WallWithPoints wall(4);
  const auto features = wall.seenFrom(SE3{}, 0);
  EXPECT_TRUE(localizeCoarsely({}, features->left, features->left, {.T_then_now = {}, .forward_m = 2, .yaw_rad = 0.1},
                               kSmallRig)
                  .empty());
}

}  // namespace
}  // namespace motorcade
