#include "frontend/shape/dense_disparity.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kDenseWidth_px = 160, kDenseHeight_px = 60;
constexpr double kBehind_px = 4, kBefore_px = 12.5;

bool isBefore(double u, double v) { return u >= 60 && u < 110 && v >= 15 && v < 45; }

/// A textured rectangle before a textured wall.
Image leftImage() {
  const test::Texture wall(1), front(2);
  return test::render(kDenseWidth_px, kDenseHeight_px,
                      [&](double u, double v) { return isBefore(u, v) ? front(u, v) : wall(u, v); });
}
Image rightImage() {
  const test::Texture wall(1), front(2);
  return test::render(kDenseWidth_px, kDenseHeight_px, [&](double u, double v) {
    return isBefore(u + kBefore_px, v) ? front(u + kBefore_px, v) : wall(u + kBehind_px, v);
  });
}

/// Semi-global matching as its paper has it, pixel by pixel: the sums over four directions of a window's costs.
class PlainMatching {
 public:
  PlainMatching(const Image& left, const Image& right, const PixelWindow& window, int count)
      : left_(left), right_(right), window_(window), count_(count), sums_(window.area() * count, 0) {
    for (const auto& [du, dv] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)})
      addPaths(du, dv);
  }
  /// Disparity of the left image; -1 where the search from the right image disagrees.
  int disparity(int u, int v) const {
    const int best = bestOf(count_, [&](int d) { return sum(u, v, d); });
    const int in_right = window_.u0 + u - best;
    const int back = bestOf(count_, [&](int d) {
      const int from = in_right + d - window_.u0;
      return from >= 0 && from < window_.width ? sum(from, v, d) : 1'000;
    });
    return in_right >= 0 && std::abs(back - best) <= 1 ? best : -1;
  }

 private:
  template <class Cost>
  static int bestOf(int count, const Cost& cost) {
    int best = 0;
    for (int d = 1; d < count; ++d)
      if (cost(d) < cost(best)) best = d;
    return best;
  }
  int sum(int u, int v, int d) const { return sums_[(v * window_.width + u) * count_ + d]; }
  static bool isDarker(const Image& image, int u, int v, int du, int dv) {
    return image.at(std::clamp(u + du, 0, image.width() - 1), std::clamp(v + dv, 0, image.height() - 1)) <
           image.at(u, v);
  }
  int cost(int u, int v, int d) const {
    constexpr int kUnknown = 12;
    if (u - d < 0) return kUnknown;
    int different = 0;
    for (int dv = -2; dv <= 2; ++dv)
      for (int du = -2; du <= 2; ++du) different += isDarker(left_, u, v, du, dv) != isDarker(right_, u - d, v, du, dv);
    return different;
  }
  void addPaths(int du, int dv) {
    constexpr int kStep = 5, kJump = 22;
    std::vector<int> path(sums_.size());
    const bool forward = du + dv > 0;
    for (int i = 0; i < window_.area(); ++i) {
      const int pixel = forward ? i : window_.area() - 1 - i, u = pixel % window_.width, v = pixel / window_.width;
      const int u_before = u - du, v_before = v - dv;
      const bool starts = u_before < 0 || v_before < 0 || u_before >= window_.width || v_before >= window_.height;
      const int* before = starts ? nullptr : &path[(v_before * window_.width + u_before) * count_];
      const int least = starts ? 0 : *std::min_element(before, before + count_);
      for (int d = 0; d < count_; ++d) {
        int way = 0;
        if (!starts) {
          way = std::min(before[d], least + kJump);
          if (d > 0) way = std::min(way, before[d - 1] + kStep);
          if (d + 1 < count_) way = std::min(way, before[d + 1] + kStep);
        }
        path[pixel * count_ + d] = cost(window_.u0 + u, window_.v0 + v, d) + way - least;
        sums_[pixel * count_ + d] += path[pixel * count_ + d];
      }
    }
  }

  const Image &left_, &right_;
  PixelWindow window_;
  int count_;
  std::vector<int> sums_;
};

class DisparitiesOfRange : public testing::TestWithParam<int> {};

TEST_P(DisparitiesOfRange, AreThoseOfPlainMatching) {
  const int count = GetParam();
  const PixelWindow window{3, 8, 120, 30};  // where the greatest disparities lead out of the right image, too
  const Image left = leftImage(), right = rightImage();
  DenseDisparity dense;
  const DisparityMap map = dense(left, right, window, {0, count});
  const PlainMatching plain(left, right, window, count);
  int known = 0;
  for (int v = 0; v < window.height; ++v)
    for (int u = 0; u < window.width; ++u) {
      if (map.at(u, v) == DisparityMap::kNone) continue;
      ++known;
      EXPECT_NEAR(map.at(u, v), plain.disparity(u, v), 0.5) << u << " " << v;
    }
  EXPECT_GT(known, 0.7 * window.area());
}

INSTANTIATE_TEST_SUITE_P(Counts, DisparitiesOfRange, testing::Values(1, 14, 32, 45));

TEST(DenseDisparity, TellsARectangleFromTheWallBehindIt) {
  DenseDisparity dense;
  const DisparityMap map = dense(leftImage(), rightImage(), {40, 5, 100, 50}, {0, 24});
  ASSERT_EQ(map.window.area(), 5000);
  int known = 0, right = 0;
  for (int row = 0; row < map.window.height; ++row)
    for (int column = 0; column < map.window.width; ++column) {
      const float d = map.at(column, row);
      if (d == DisparityMap::kNone) continue;
      ++known;
      const double truth_px = isBefore(40 + column, 5 + row) ? kBefore_px : kBehind_px;
      right += std::abs(d - truth_px) < 0.6;
    }
  EXPECT_GT(known, 4000);
  EXPECT_GT(right, 0.93 * known);
}

TEST(DenseDisparity, KnowsNothingWhereThereIsNoTextureOrNoCounterpart) {
  DenseDisparity dense;
  const Image plain = test::render(kDenseWidth_px, kDenseHeight_px, [](double, double) { return 90.0; });
  for (const float d : dense(plain, plain, {40, 5, 60, 40}, {0, 16}).disparity_px) EXPECT_EQ(d, DisparityMap::kNone);
  // Just left of the rectangle, the right camera sees the rectangle.
  const DisparityMap map = dense(leftImage(), rightImage(), {40, 5, 100, 50}, {0, 24});
  int hidden_known = 0;
  for (int row = 15; row < 35; ++row)
    for (int column = 13; column < 17; ++column) hidden_known += map.at(column, row) != DisparityMap::kNone;
  EXPECT_LT(hidden_known, 50);  // of 80
}

TEST(DenseDisparity, DoesNotDependOnCallsBefore) {
  DenseDisparity used, fresh;
  used(leftImage(), rightImage(), {0, 0, 150, 60}, {2, 30});
  EXPECT_EQ(used(leftImage(), rightImage(), {40, 5, 50, 40}, {0, 20}).disparity_px,
            fresh(leftImage(), rightImage(), {40, 5, 50, 40}, {0, 20}).disparity_px);
}

TEST(DenseDisparity, CutsWindowAndRangeToWhatThereIs) {
  DenseDisparity dense;
  const DisparityMap map = dense(leftImage(), rightImage(), {-20, -5, 60, 500}, {-3, 20});
  EXPECT_EQ(map.window.u0, 0);
  EXPECT_EQ(map.window.width, 40);
  EXPECT_EQ(map.window.height, kDenseHeight_px);
  EXPECT_TRUE(dense(leftImage(), rightImage(), {kDenseWidth_px + 5, 0, 20, 20}, {0, 8}).window.empty());
  EXPECT_TRUE(dense(leftImage(), rightImage(), {0, 0, 20, 20}, {-9, 8}).window.empty());
}

}  // namespace
}  // namespace motorcade
