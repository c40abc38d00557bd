#include "frontend/matching/young_point_search.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "frontend/features/feature_preparation.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kSearchedWidth_px = 480, kSearchedHeight_px = 240;
constexpr double kSearchRoundTrip_px = 0.5, kMaxFlow_px = 250;

/// A textured wall before and after a shift.
struct SearchedWall {
  explicit SearchedWall(double shift_px) {
    const test::Texture texture(93, 8, 40);
    const Image before_image = test::render(kSearchedWidth_px, kSearchedHeight_px, texture, {.noise = 1, .seed = 1});
    const Image now_image = test::render(kSearchedWidth_px, kSearchedHeight_px,
                                         [&](double x, double y) { return texture(x - shift_px, y); },
                                         {.gain = 0.9, .noise = 1, .seed = 2});
    const FeaturePreparation prepare{{}};
    before = prepare(test::stereoFrame(0, before_image, before_image));
    now = prepare(test::stereoFrame(1, now_image, now_image));
  }
  FeaturesPtr before, now;
};

/// Share of the corners that are found where they went, when all neighbors seem to have moved by `neighbors_px`.
double foundShare(double shift_px, float neighbors_px) {
  const SearchedWall wall(shift_px);
  const PointFollower follower(wall.before->left, wall.now->left, kSearchRoundTrip_px);
  std::vector<MovedPoint> neighbors;
  for (float u = 20; u < kSearchedWidth_px; u += 40) neighbors.push_back({{u, 120}, {neighbors_px, 0}});
  const YoungPointSearch search(follower, *wall.before, *wall.now, {neighbors, kSearchedWidth_px, kSearchedHeight_px},
                                kMaxFlow_px);
  int asked = 0, right = 0;
  for (const Corner& corner : wall.before->corners) {
    if (corner.u_px + shift_px > kSearchedWidth_px - 20) continue;  // it leaves the image
    ++asked;
    const auto found = search({.point = {0}, .u_px = corner.u_px, .v_px = corner.v_px});
    right += found && std::abs(found->u_px - corner.u_px - shift_px) < 0.3 && std::abs(found->v_px - corner.v_px) < 0.3;
  }
  return static_cast<double>(right) / asked;
}

TEST(YoungPointSearch, FindsPointsThatMoveWithTheirNeighbors) { EXPECT_GT(foundShare(37.4, 36), 0.8); }

TEST(YoungPointSearch, FindsPointsThatMoveOtherwiseByCornersThatLookLikeThem) {
  EXPECT_GT(foundShare(12.4, 0), 0.7);    // near
  EXPECT_GT(foundShare(100.4, 10), 0.5);  // far
}

}  // namespace
}  // namespace motorcade
