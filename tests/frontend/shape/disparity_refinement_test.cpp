#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "frontend/shape/dense_disparity.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kRefinedWidth_px = 160, kRefinedHeight_px = 60;

TEST(DisparityRefinement, IsMoreExactInTheImagesOfTwiceTheSize) {
  // What is seen here at half size: the wall's disparity is 2.3 there.
  constexpr double kTrue_px = 4.6;
  const test::Texture wall(1);
  const auto seen = [&](double shift_px, int scale) {
    return test::render(kRefinedWidth_px * 2 / scale, kRefinedHeight_px * 2 / scale,
                        [&, shift_px, scale](double u, double v) {
                          return wall(scale * (u + 0.5) - 0.5 + shift_px, scale * (v + 0.5) - 0.5);
                        });
  };
  DenseDisparity dense;
  DisparityMap map = dense(seen(0, 2), seen(kTrue_px, 2), {40, 5, 100, 50}, {0, 12});
  const auto meanError = [&] {
    double sum_px = 0;
    int known = 0;
    for (const float d : map.disparity_px)
      if (d != DisparityMap::kNone) sum_px += std::abs(d - kTrue_px / 2), ++known;
    EXPECT_GT(known, 4000);
    return sum_px / known;
  };
  const double before_px = meanError();
  std::vector<int> cells(map.disparity_px.size());
  std::iota(cells.begin(), cells.end(), 0);
  refineDisparities(seen(0, 1), seen(kTrue_px, 1), 2, cells, map);
  EXPECT_LT(meanError(), 0.6 * before_px);
  EXPECT_LT(meanError(), 0.06);
}

}  // namespace
}  // namespace motorcade
