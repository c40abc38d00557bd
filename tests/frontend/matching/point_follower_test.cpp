#include "frontend/matching/point_follower.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "frontend/image/image_pyramid.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kFollowedWidth_px = 320, kFollowedHeight_px = 200, kLevel = 1;
constexpr float kShiftU_px = 14.3F, kShiftV_px = -5.6F;
constexpr double kMaxRoundTrip_px = 0.5;
constexpr Shift kGuess{kShiftU_px + 1.5F, kShiftV_px - 1};

/// A textured wall before and after a shift.
struct FollowedWall {
  test::Texture texture{91, 8, 40};
  ImagePool pool;
  ImagePyramid before =
      buildPyramid(test::render(kFollowedWidth_px, kFollowedHeight_px, texture, {.noise = 1, .seed = 1}), 4, pool);
  ImagePyramid now =
      buildPyramid(test::render(kFollowedWidth_px, kFollowedHeight_px,
                                [this](double x, double y) { return texture(x - kShiftU_px, y - kShiftV_px); },
                                {.gain = 0.9, .noise = 1, .seed = 2}),
                   4, pool);
  PointFollower follower{before, now, kMaxRoundTrip_px};
};

/// Points whose patches stay inside the image.
std::vector<FlowObservation> innerPoints() {
  std::vector<FlowObservation> points;
  for (float v = 40; v < kFollowedHeight_px - 40; v += 19.3F)
    for (float u = 40; u < kFollowedWidth_px - 40; u += 23.7F) points.push_back({.point = {0}, .u_px = u, .v_px = v});
  return points;
}

TEST(PointFollower, FollowsAGuessThatIsNear) {
  const FollowedWall wall;
  int followed = 0;
  const auto points = innerPoints();
  for (const FlowObservation& point : points) {
    const auto found = wall.follower.follow(point, kGuess, kLevel);
    if (!found) continue;
    ++followed;
    EXPECT_NEAR(found->u_px, point.u_px + kShiftU_px, 0.2);
    EXPECT_NEAR(found->v_px, point.v_px + kShiftV_px, 0.2);
  }
  EXPECT_GT(followed, 0.9 * static_cast<double>(points.size()));
}

TEST(PointFollower, FitsBestWhereTheGuessIsRight) {
  const FollowedWall wall;
  int fits = 0;
  const auto points = innerPoints();
  for (const FlowObservation& point : points) {
    const auto patch = wall.follower.patchAt(point, kLevel);
    const auto right = wall.follower.fit(point, patch, kGuess, kLevel),
               wrong = wall.follower.fit(point, patch, {-20, 3}, kLevel);
    if (!right) continue;
    ++fits;
    EXPECT_NEAR(right->shift.du_px, kShiftU_px, 0.5);
    EXPECT_NEAR(right->shift.dv_px, kShiftV_px, 0.5);
    EXPECT_LT(wrong ? wrong->ncc : 0, right->ncc);
  }
  EXPECT_GT(fits, 0.9 * static_cast<double>(points.size()));
}

TEST(PointFollower, TakesTheGuessForAPointWithoutACoarsePatch) {
  const FollowedWall wall;
  const auto fit = wall.follower.fit(innerPoints().front(), std::nullopt, kGuess, kLevel);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->shift.du_px, kGuess.du_px);
  EXPECT_EQ(fit->shift.dv_px, kGuess.dv_px);
}

TEST(PointFollower, GivesUpWhenTheWayBackLeadsElsewhere) {
  const FollowedWall wall;
  const PointFollower strict(wall.before, wall.now, 1e-9);
  for (const FlowObservation& point : innerPoints()) EXPECT_FALSE(strict.follow(point, kGuess, kLevel));
}

TEST(PointFollower, FindsNothingInAnotherScene) {
  const FollowedWall wall;
  ImagePool pool;
  const ImagePyramid other =
      buildPyramid(test::render(kFollowedWidth_px, kFollowedHeight_px, test::Texture(92, 8, 40)), 4, pool);
  const PointFollower follower(wall.before, other, kMaxRoundTrip_px);
  int followed = 0;
  const auto points = innerPoints();
  for (const FlowObservation& point : points) followed += follower.follow(point, kGuess, kLevel).has_value();
  EXPECT_LE(followed, 0.1 * static_cast<double>(points.size()));
}

}  // namespace
}  // namespace motorcade
