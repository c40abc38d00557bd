#include "frontend/matching/corner_lookup.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "frontend/features/feature_preparation.hpp"
#include "frontend/image/image_pyramid.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kLookupWidth_px = 320, kLookupHeight_px = 200;
constexpr float kLookupShiftU_px = 17, kLookupShiftV_px = -6;

FeaturesPtr prepare(const std::function<double(double, double)>& gray, const test::Exposure& exposure) {
  const Image image = test::render(kLookupWidth_px, kLookupHeight_px, gray, exposure);
  return FeaturePreparation({})(test::stereoFrame(0, image, image));
}

/// A textured wall before and after a shift.
struct TwoImages {
  test::Texture texture{81, 7, 40};
  FeaturesPtr before = prepare(texture, {.noise = 2, .seed = 1});
  FeaturesPtr now = prepare([this](double x, double y) { return texture(x - kLookupShiftU_px, y - kLookupShiftV_px); },
                            {.gain = 0.9, .bias = 12, .noise = 2, .seed = 2});
};

Eigen::Vector2f positionOf(const Corner& corner) { return {corner.u_px, corner.v_px}; }

Signature lookOf(const Corner& corner, const FeaturesPtr& features) {
  return {features->left, corner.u_px, corner.v_px};
}

/// The pixels that a signature holds, one by one.
std::vector<int> signaturePixels(const ImagePyramid& pyramid, float u_px, float v_px) {
  std::vector<int> pixels;
  for (int level = 0; level < 2; ++level) {
    const Image& image = pyramid.levels[level];
    const int x = std::clamp(static_cast<int>(std::lround(toLevel(u_px, level))) - 4, 0, image.width() - 8);
    const int y = std::clamp(static_cast<int>(std::lround(toLevel(v_px, level))) - 4, 0, image.height() - 8);
    int sum = 0;
    for (int i = 0; i < 64; ++i) sum += image.at(x + i % 8, y + i / 8);
    for (int i = 0; i < 64; ++i) pixels.push_back(std::clamp(image.at(x + i % 8, y + i / 8) + 128 - sum / 64, 0, 255));
  }
  return pixels;
}

int difference(const std::vector<int>& a, const std::vector<int>& b) {
  int sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum;
}

/// The shifts that `addSimilar` must add, found by comparison with every corner.
std::vector<Shift> similarByBruteForce(const Corner& point, const TwoImages& images, const ShiftBounds& bounds,
                                       double max_difference) {
  const auto looks = signaturePixels(images.before->left, point.u_px, point.v_px);
  std::vector<std::pair<int, int>> candidates;
  const std::vector<Corner>& corners = images.now->corners;
  for (int i = 0; i < static_cast<int>(corners.size()); ++i) {
    const float du = corners[i].u_px - point.u_px, dv = corners[i].v_px - point.v_px;
    if (du < bounds.min_du_px || du > bounds.max_du_px || dv < bounds.min_dv_px || dv > bounds.max_dv_px) continue;
    const int sum = difference(looks, signaturePixels(images.now->left, corners[i].u_px, corners[i].v_px));
    if (sum < max_difference * 128) candidates.emplace_back(sum, i);
  }
  std::ranges::sort(candidates);
  std::vector<Shift> shifts;
  for (std::size_t k = 0; k < std::min<std::size_t>(2, candidates.size()); ++k) {
    const Corner& corner = corners[candidates[k].second];
    shifts.push_back({corner.u_px - point.u_px, corner.v_px - point.v_px});
  }
  return shifts;
}

TEST(CornerLookup, FindsTheTwoMostSimilarCornersOfAll) {
  const TwoImages images;
  const CornerLookup lookup(*images.now);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> center(-30, 30), reach(1, 40);
  int two = 0, one = 0, none = 0;
  for (const Corner& corner : images.before->corners) {
    const float du = center(random), dv = center(random), reach_u = reach(random), reach_v = reach(random);
    const ShiftBounds bounds{du - reach_u, du + reach_u, dv - reach_v, dv + reach_v};
    for (const double max_difference : {255.0, 12.0}) {
      const auto expected = similarByBruteForce(corner, images, bounds, max_difference);
      Guesses guesses;
      lookup.addSimilar(lookOf(corner, images.before), positionOf(corner), bounds, max_difference, guesses);
      ASSERT_EQ(guesses.count, expected.size());
      for (std::size_t k = 0; k < expected.size(); ++k) {
        EXPECT_EQ(guesses.shifts[k].du_px, expected[k].du_px);
        EXPECT_EQ(guesses.shifts[k].dv_px, expected[k].dv_px);
      }
      ++(expected.size() == 2 ? two : expected.size() == 1 ? one : none);
    }
  }
  EXPECT_GT(two, 50);  // the bounds are wide and narrow enough for each outcome
  EXPECT_GT(one, 50);
  EXPECT_GT(none, 50);
}

TEST(CornerLookup, GuessesTheShiftOfMostCorners) {
  const TwoImages images;
  const CornerLookup lookup(*images.now);
  int right = 0;
  for (const Corner& corner : images.before->corners) {
    Guesses guesses;
    lookup.addSimilar(lookOf(corner, images.before), positionOf(corner), {-60, 60, -60, 60}, 255, guesses);
    right += std::ranges::any_of(guesses.all(), [](const Shift& shift) {
      return std::hypot(shift.du_px - kLookupShiftU_px, shift.dv_px - kLookupShiftV_px) < 1.5;
    });
  }
  EXPECT_GT(right, 0.7 * static_cast<double>(images.before->corners.size()));  // some leave the image, others are lost
}

TEST(CornerLookup, PrefersTheFirstOfCornersThatLookTheSame) {
  const auto flat = prepare([](double, double) { return 100.0; }, {});
  Features features = *flat;
  features.corners = {{250, 150, 1}, {200, 100, 1}, {30, 20, 1}, {100, 50, 1}};
  Guesses guesses;
  const Corner point{150, 80, 1};
  CornerLookup(features).addSimilar(lookOf(point, flat), positionOf(point), {-160, 160, -160, 160}, 255, guesses);
  ASSERT_EQ(guesses.count, 2U);
  EXPECT_EQ(guesses.shifts[0].du_px, 100);
  EXPECT_EQ(guesses.shifts[1].du_px, 50);
}

TEST(CornerLookup, AddsToGuessesThatAreThere) {
  const TwoImages images;
  Guesses guesses;
  guesses.add({1, 2});
  const Corner& point = images.before->corners.front();
  CornerLookup(*images.now)
      .addSimilar(lookOf(point, images.before), positionOf(point), {-60, 60, -60, 60}, 255, guesses);
  ASSERT_GT(guesses.count, 1U);
  EXPECT_EQ(guesses.shifts[0].du_px, 1);
  EXPECT_EQ(guesses.shifts[0].dv_px, 2);
}

TEST(Signature, DoesNotSeeTheExposuresBias) {
  const test::Texture texture(82, 8, 40);
  const auto dim = prepare(texture, {}), bright = prepare(texture, {.bias = 30});
  const test::Texture other(83, 8, 40);
  const auto another = prepare(other, {});
  const Signature here(dim->left, 100, 80), brighter(bright->left, 100, 80), elsewhere(another->left, 100, 80);
  EXPECT_EQ(here.distance(here), 0);
  EXPECT_LE(here.distance(brighter), Signature::kPixels);  // a gray level per pixel: the means are rounded
  EXPECT_GT(here.distance(elsewhere), 10 * Signature::kPixels);
}

}  // namespace
}  // namespace motorcade
