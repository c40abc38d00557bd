#include "frontend/features/corner_detector.hpp"

#include <set>

#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

const CornerDetector::Params kParams;
constexpr int kBorder_px = 9;  // window, smoothing and minimum distance

/// A bright square on a dark ground, with the given contrast.
Image squareImage(double left, double top, double side, double contrast) {
  const auto gray = [=](double x, double y) {
    return x >= left && x < left + side && y >= top && y < top + side ? 100 + contrast : 100;
  };
  return test::render(200, 160, gray);
}

TEST(CornerDetector, FindsTheFourCornersOfASquareAndNothingOnItsEdges) {
  const auto corners = CornerDetector(kParams)(squareImage(60, 50, 50, 80));
  ASSERT_EQ(corners.size(), 4U);
  for (const Corner& corner : corners) {
    const double du_px = std::min(std::abs(corner.u_px - 59.5), std::abs(corner.u_px - 109.5));
    const double dv_px = std::min(std::abs(corner.v_px - 49.5), std::abs(corner.v_px - 99.5));
    EXPECT_LE(std::max(du_px, dv_px), 3.5);  // the window that holds both edges best lies inside the corner
  }
}

TEST(CornerDetector, FindsFaintCorners) { EXPECT_EQ(CornerDetector(kParams)(squareImage(60, 50, 50, 12)).size(), 4U); }

TEST(CornerDetector, DetectsNoCornersInNoise) {
  const auto flat = [](double, double) { return 90.0; };
  EXPECT_TRUE(CornerDetector(kParams)(test::render(300, 200, flat, {.noise = 2})).empty());
  EXPECT_LE(CornerDetector(kParams)(test::render(300, 200, flat, {.noise = 12})).size(), 5U);
}

TEST(CornerDetector, GivesEachCellItsShareBesideStrongTexture) {
  const test::Texture texture(3);
  const auto gray = [&](double x, double y) { return x < 200 ? texture(x, y) : 60 + 0.25 * (texture(x, y) - 128); };
  CornerDetector::Params params;
  params.max_corners = 200;
  const auto corners = CornerDetector(params)(test::render(400, 240, gray));
  EXPECT_LE(corners.size(), 200U);
  const auto faint = std::ranges::count_if(corners, [](const Corner& corner) { return corner.u_px >= 200; });
  EXPECT_GE(faint, 70);  // half of the area, less the border
  std::set<std::pair<int, int>> cells;
  for (const Corner& corner : corners)
    cells.emplace(static_cast<int>(corner.u_px) / CornerDetector::kCell_px,
                  static_cast<int>(corner.v_px) / CornerDetector::kCell_px);
  EXPECT_GE(cells.size(), 120U);  // of 170
}

TEST(CornerDetector, KeepsCornersApartAndOffTheBorder) {
  const test::Texture texture(4);
  const auto corners = CornerDetector(kParams)(test::render(320, 200, texture));
  ASSERT_GT(corners.size(), 50U);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_GE(corners[i].u_px, kBorder_px);
    EXPECT_LE(corners[i].v_px, 199 - kBorder_px);
    for (std::size_t j = 0; j < i; ++j) {
      const float apart_px =
          std::max(std::abs(corners[i].u_px - corners[j].u_px), std::abs(corners[i].v_px - corners[j].v_px));
      EXPECT_GT(apart_px, CornerDetector::kMinDistance_px);
    }
  }
}

TEST(CornerDetector, FindsTheSameWithAnyNumberOfThreads) {
  const Image image = test::render(320, 200, test::Texture(5), {.noise = 2});
  const auto found = [&](int threads) {
    tbb::task_arena arena(threads, static_cast<unsigned>(threads));
    return arena.execute([&] { return CornerDetector(kParams)(image); });
  };
  const auto expected = found(1);
  ASSERT_GT(expected.size(), 50U);
  for (const int threads : {2, 3, 4, 7}) {
    const auto corners = found(threads);
    ASSERT_EQ(corners.size(), expected.size()) << threads;
    for (std::size_t i = 0; i < corners.size(); ++i)
      EXPECT_TRUE(corners[i].u_px == expected[i].u_px && corners[i].v_px == expected[i].v_px &&
                  corners[i].score == expected[i].score);
  }
}

TEST(CornerDetector, AcceptsImagesTooSmallForAnyCorner) {
  EXPECT_TRUE(CornerDetector(kParams)(test::render(17, 12, test::Texture(1))).empty());
}

}  // namespace
}  // namespace motorcade
