#include "frontend/image/patch_alignment.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "frontend/image/image_pyramid.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

constexpr int kAlignedWidth_px = 260, kAlignedHeight_px = 140;

/// Calls f(u, v) for positions of patches, off the border and at varying fractions of a pixel.
template <class Function>
void forEachPosition(double border_px, const Function& f) {
  for (double v = border_px; v < kAlignedHeight_px - border_px; v += 17.3)
    for (double u = border_px; u < kAlignedWidth_px - border_px; u += 19.7) f(u, v);
}

struct ErrorStatistics {
  double sum = 0, squares = 0, squares_over_variance = 0;
  int count = 0;
  void add(double error, double sigma) {
    sum += error;
    squares += error * error;
    squares_over_variance += error * error / (sigma * sigma);
    ++count;
  }
  double mean() const { return sum / count; }
  double rms() const { return std::sqrt(squares / count); }
  double nees() const { return squares_over_variance / count; }
};

TEST(PatchAlignment, FindsSubPixelShiftsUnderGainBiasAndNoise) {
  const test::Texture texture(11);
  const Image from = test::render(kAlignedWidth_px, kAlignedHeight_px, texture, {.noise = 1.5, .seed = 1});
  for (const double shift_px : {0.0, 0.25, 0.5, 0.8}) {
    const auto moved = [&](double x, double y) { return texture(x - 1 - shift_px, y + shift_px); };
    const Image to =
        test::render(kAlignedWidth_px, kAlignedHeight_px, moved, {.gain = 0.8, .bias = 15, .noise = 1.5, .seed = 2});
    ErrorStatistics u_error, v_error;
    forEachPosition(20, [&](double u, double v) {
      const auto patch =
          makeTemplate(from, static_cast<float>(u), static_cast<float>(v), kPatchWindow_px, PatchDeformation::kScale);
      ASSERT_TRUE(patch);
      const auto aligned = alignPatch(*patch, to, Eigen::Vector2d(u, v).cast<float>(), {});
      if (!aligned) return;  // 2 px away is too far for a few of them
      u_error.add(aligned->u_px - (u + 1 + shift_px), aligned->sigma_px);
      v_error.add(aligned->v_px - (v - shift_px), aligned->sigma_px);
    });
    EXPECT_GE(u_error.count, 60);                           // of 72
    EXPECT_LT(std::abs(u_error.mean()), 0.02) << shift_px;  // three times the standard error of some 80 positions
    EXPECT_LT(std::abs(v_error.mean()), 0.02) << shift_px;
    EXPECT_LT(u_error.rms(), 0.1) << shift_px;
    EXPECT_LT(v_error.rms(), 0.1) << shift_px;
    EXPECT_LT(u_error.nees(), 1.2) << shift_px;  // the floor of sigma makes it cautious on perfect images
  }
}

TEST(PatchAlignment, PyramidReachesFarShifts) {
  const test::Texture coarse(12, 60, 200), fine(17, 8, 20);
  const auto texture = [&](double x, double y) { return 0.8 * coarse(x, y) + 0.4 * (fine(x, y) - 128) + 0.2 * 128; };
  const auto moved = [&](double x, double y) { return texture(x - 21.3, y + 9.6); };
  ImagePool pool;
  const ImagePyramid from = buildPyramid(test::render(kAlignedWidth_px, kAlignedHeight_px, texture), 4, pool);
  const ImagePyramid to = buildPyramid(test::render(kAlignedWidth_px, kAlignedHeight_px, moved), 4, pool);
  int found = 0, tried = 0;
  forEachPosition(45, [&](double u, double v) {
    ++tried;
    const Eigen::Vector2f point_px = Eigen::Vector2d(u, v).cast<float>();
    const auto aligned = alignPatch(from, point_px, to, point_px, 3, {});
    if (!aligned || aligned->ncc < 0.95) return;
    ++found;
    EXPECT_NEAR(aligned->u_px, u + 21.3, 0.2);
    EXPECT_NEAR(aligned->v_px, v - 9.6, 0.2);
  });
  EXPECT_GT(found, 0.8 * tried);
}

TEST(PatchAlignment, ScaleChangeMovesNoPoint) {
  const test::Texture texture(13, 8, 30);
  const Image from = test::render(kAlignedWidth_px, kAlignedHeight_px, texture);
  ErrorStatistics error, growth;
  forEachPosition(25, [&](double u, double v) {
    constexpr double kScale = 1.08;
    const auto grown = [&](double x, double y) { return texture(u + (x - u) / kScale, v + (y - v) / kScale); };
    const Image to = test::render(kAlignedWidth_px, kAlignedHeight_px, grown);
    const auto patch =
        makeTemplate(from, static_cast<float>(u), static_cast<float>(v), kPatchWindow_px, PatchDeformation::kScale);
    const auto aligned = patch ? alignPatch(*patch, to, Eigen::Vector2d(u, v).cast<float>(), {}) : std::nullopt;
    if (!aligned) return;
    error.add(std::hypot(aligned->u_px - u, aligned->v_px - v), aligned->sigma_px);
    growth.add(aligned->log_growth - std::log(kScale), 1);
  });
  EXPECT_GT(error.count, 20);
  EXPECT_LT(error.rms(), 0.1);
  EXPECT_LT(growth.rms(), 0.02);  // the prior pulls it towards none
}

TEST(PatchAlignment, AlignsATemplateMadeAtTheScaleOfNow) {
  const test::Texture texture(18, 8, 30);
  const Image from = test::render(kAlignedWidth_px, kAlignedHeight_px, texture);
  constexpr float kScale = 1.4F;
  const auto grown = [&](double x, double y) {
    return texture(120.3 + (x - 131.8) / kScale, 65.6 + (y - 60.1) / kScale);
  };
  const Image to = test::render(kAlignedWidth_px, kAlignedHeight_px, grown);
  const auto patch = makeTemplate(from, 120.3F, 65.6F, 11, PatchDeformation::kScale, kScale);
  ASSERT_TRUE(patch);
  const auto aligned = alignPatch(*patch, to, {131, 61}, {});
  ASSERT_TRUE(aligned);
  EXPECT_NEAR(aligned->u_px, 131.8, 0.05);
  EXPECT_NEAR(aligned->v_px, 60.1, 0.05);
  EXPECT_NEAR(aligned->log_growth, 0, 0.02);
}

/// Leaves not-a-number on the part of the stack that the next call uses.
[[gnu::noinline]] void poisonStack() {
  volatile float garbage[8192];
  for (volatile float& value : garbage) value = std::nanf("");
}

TEST(PatchAlignment, TakesNothingFromUninitializedMemory) {
  const Image image = test::render(kAlignedWidth_px, kAlignedHeight_px, test::Texture(11), {.noise = 1.5, .seed = 1});
  for (const float scale : {1.0F, 1.1F}) {
    for (const int window_px : {9, 11, kMaxPatchWindow_px}) {
      poisonStack();
      const auto patch = makeTemplate(image, 120.3F, 65.6F, window_px, PatchDeformation::kScale, scale);
      ASSERT_TRUE(patch);
      EXPECT_TRUE(std::isfinite(patch->norm));
      for (const FourFloats& column : patch->inverse_hessian)
        for (int i = 0; i < 4; ++i)
          EXPECT_TRUE(std::isfinite(column[i])) << "window " << window_px << ", scale " << scale;
    }
  }
}

TEST(PatchAlignment, RejectsPatchesWithoutTexture) {
  const Image flat = test::render(64, 64, [](double, double) { return 100.0; });
  EXPECT_FALSE(makeTemplate(flat, 30, 30, 11, PatchDeformation::kScale));
  const Image stripes = test::render(64, 64, [](double, double y) { return 100 + 40 * std::sin(y); });
  EXPECT_FALSE(makeTemplate(stripes, 30, 30, 11, PatchDeformation::kSlope));
  EXPECT_FALSE(makeTemplate(stripes, 30, 30, 11, PatchDeformation::kScale));
}

TEST(PatchAlignment, RejectsAnotherScene) {
  const Image from = test::render(kAlignedWidth_px, kAlignedHeight_px, test::Texture(14)),
              to = test::render(kAlignedWidth_px, kAlignedHeight_px, test::Texture(15));
  PatchParams params;
  params.min_ncc = 0.9;
  int found = 0, tried = 0;
  forEachPosition(20, [&](double u, double v) {
    ++tried;
    const auto patch =
        makeTemplate(from, static_cast<float>(u), static_cast<float>(v), kPatchWindow_px, PatchDeformation::kScale);
    found += patch && alignPatch(*patch, to, Eigen::Vector2d(u, v).cast<float>(), params);
  });
  EXPECT_LE(found, tried / 20);
}

TEST(PatchAlignment, ReadsNothingOutsideTheImage) {  // for the sanitizers; the border is repeated
  const Image image = test::render(33, 20, test::Texture(16));
  for (const float u : {0.0F, 0.3F, 16.0F, 31.9F, 32.0F})
    for (const float v : {0.0F, 0.7F, 18.9F, 19.0F})
      if (const auto patch = makeTemplate(image, u, v, kMaxPatchWindow_px, PatchDeformation::kScale))
        alignPatch(*patch, image, {u, v}, {});
  EXPECT_FALSE(makeTemplate(image, -0.1F, 5, 11, PatchDeformation::kScale));
}

TEST(RefineDisparity, HasNoBiasByTheFractionOfTheDisparity) {
  const test::Texture texture(21);
  const Image left = test::render(kAlignedWidth_px, kAlignedHeight_px, texture, {.noise = 1.5, .seed = 3});
  for (int tenths = 0; tenths < 10; ++tenths) {
    const double disparity_px = 20 + 0.1 * tenths;
    const auto shifted = [&](double x, double y) { return texture(x + disparity_px, y); };
    const Image right =
        test::render(kAlignedWidth_px, kAlignedHeight_px, shifted, {.gain = 1.1, .bias = -8, .noise = 1.5, .seed = 4});
    ErrorStatistics error;
    forEachPosition(45, [&](double u, double v) {
      const auto match = refineDisparity(left, right, u, v, disparity_px + (tenths % 3 - 1) * 1.5);
      if (match) error.add(match->disparity_px - disparity_px, match->sigma_px);
    });
    EXPECT_GE(error.count, 25);
    EXPECT_LT(std::abs(error.mean()), 0.03) << disparity_px;
    EXPECT_LT(error.rms(), 0.1) << disparity_px;
    EXPECT_LT(error.nees(), 1.2) << disparity_px;
  }
}

TEST(RefineDisparity, FollowsTheSlopeOfTheRoad) {
  const test::Texture texture(22);
  const Image left = test::render(kAlignedWidth_px, kAlignedHeight_px, texture);
  constexpr double kSlope = 0.33;  // px per row: a camera 1.65 m above the road, 0.54 m of baseline
  ErrorStatistics error;
  // The right image shows at (x, y) what the left one shows at (x + d(y), y).
  const Image right = test::render(kAlignedWidth_px, kAlignedHeight_px,
                                   [&](double x, double y) { return texture(x + 10 + kSlope * (y - 70), y); });
  forEachPosition(42, [&](double u, double v) {
    const double disparity_px = 10 + kSlope * (v - 70);
    const auto match = refineDisparity(left, right, u, v, disparity_px + 0.8);
    if (match) error.add(match->disparity_px - disparity_px, match->sigma_px);
  });
  EXPECT_GE(error.count, 20);
  EXPECT_LT(error.rms(), 0.1);
}

}  // namespace
}  // namespace motorcade
