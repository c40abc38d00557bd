#include "frontend/matching/point_follower.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "frontend/image/image_pyramid.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kWidth = 320, kHeight = 200, kLevel = 1;
constexpr float kShiftU_px = 14.3F, kShiftV_px = -5.6F;
constexpr double kMaxRoundTrip_px = 0.5;
constexpr std::array kGuesses{Shift{-20, 3}, Shift{kShiftU_px + 1.5F, kShiftV_px - 1}};

/// A textured wall before and after a shift.
struct Wall {
  test::Texture texture{91, 8, 40};
  ImagePool pool;
  ImagePyramid before = buildPyramid(test::render(kWidth, kHeight, texture, {.noise = 1, .seed = 1}), 4, pool);
  ImagePyramid now = buildPyramid(
      test::render(kWidth, kHeight, [this](double x, double y) { return texture(x - kShiftU_px, y - kShiftV_px); },
                   {.gain = 0.9, .noise = 1, .seed = 2}),
      4, pool);
  PointFollower follower{before, now, kMaxRoundTrip_px};
};

/// Points whose patches stay inside the image.
std::vector<FlowObservation> innerPoints() {
  std::vector<FlowObservation> points;
  for (float v = 40; v < kHeight - 40; v += 19.3F)
    for (float u = 40; u < kWidth - 40; u += 23.7F) points.push_back({.point = {0}, .u_px = u, .v_px = v});
  return points;
}

TEST(PointFollower, FollowsTheBestOfSeveralGuesses) {
  const Wall wall;
  int followed = 0;
  const auto points = innerPoints();
  for (const FlowObservation& point : points) {
    const auto found = wall.follower.follow(point, wall.follower.patchAt(point, kLevel), kGuesses, kLevel);
    if (!found) continue;
    ++followed;
    EXPECT_NEAR(found->u_px, point.u_px + kShiftU_px, 0.2);
    EXPECT_NEAR(found->v_px, point.v_px + kShiftV_px, 0.2);
  }
  EXPECT_GT(followed, 0.9 * static_cast<double>(points.size()));
}

TEST(PointFollower, TakesTheFirstGuessForAPointWithoutACoarsePatch) {
  const Wall wall;
  const std::array guesses{kGuesses[1], kGuesses[0]};
  int followed = 0;
  const auto points = innerPoints();
  for (const FlowObservation& point : points)
    followed += wall.follower.follow(point, std::nullopt, guesses, kLevel).has_value();
  EXPECT_GT(followed, 0.9 * static_cast<double>(points.size()));
}

TEST(PointFollower, GivesUpWhenTheWayBackLeadsElsewhere) {
  const Wall wall;
  const PointFollower strict(wall.before, wall.now, 1e-9);
  for (const FlowObservation& point : innerPoints())
    EXPECT_FALSE(strict.follow(point, strict.patchAt(point, kLevel), kGuesses, kLevel));
}

TEST(PointFollower, FindsNothingInAnotherScene) {
  const Wall wall;
  ImagePool pool;
  const ImagePyramid other = buildPyramid(test::render(kWidth, kHeight, test::Texture(92, 8, 40)), 4, pool);
  const PointFollower follower(wall.before, other, kMaxRoundTrip_px);
  int followed = 0;
  const auto points = innerPoints();
  for (const FlowObservation& point : points)
    followed += follower.follow(point, follower.patchAt(point, kLevel), kGuesses, kLevel).has_value();
  EXPECT_LE(followed, 0.1 * static_cast<double>(points.size()));
}

}  // namespace
}  // namespace motorcade
