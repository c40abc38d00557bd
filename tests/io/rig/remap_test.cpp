#include "io/rig/remap.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include <gtest/gtest.h>

#include "io/rig/rectification.hpp"
#include "tests/io/rig/rigs_by_hand.hpp"

namespace motorcade {
namespace {

using test::equidistantCamera;
using test::kSize;
using test::radialCamera;
using test::rigOf;

Image noiseImage(ImagePool& pool, ImageSize size = kSize) {
  std::mt19937 generator(7);
  Image image = pool.acquire(size.width, size.height);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) image.mutableRow(y)[x] = static_cast<std::uint8_t>(generator() >> 24);
  return image;
}

Remap leftRemap(const Rig& rig) {
  const Rectification pair = rectificationOf(rig, kSize);
  return {rig.left, pair.R_left, pair.camera, kSize};
}

TEST(Remap, EveryPixelComesFromWhereItsRayIsImaged) {
  constexpr double kHalfStep_px = 0.5 / (1 << Remap::kFractionBits) + 1e-9;
  for (const LensCamera& camera : {radialCamera(), equidistantCamera()}) {
    const Rig rig = rigOf(camera);
    const Rectification pair = rectificationOf(rig, kSize);
    const Remap remap = leftRemap(rig);
    const LensModel lens(rig.left);
    for (int v = 0; v < kSize.height; ++v)
      for (int u = 0; u < kSize.width; ++u) {
        const Eigen::Vector3d ray((u - pair.camera.cx_px) / pair.camera.fx_px,
                                  (v - pair.camera.cy_px) / pair.camera.fy_px, 1);
        const auto exact_px = lens.project(pair.R_left.transpose() * ray);
        ASSERT_TRUE(exact_px);
        ASSERT_LT((remap.source_px(u, v) - *exact_px).cwiseAbs().maxCoeff(), kHalfStep_px) << u << " " << v;
      }
  }
}

TEST(Remap, PixelsAreTheBilinearMeanOfFourToTheNearestLevel) {
  ImagePool pool;
  const Image raw = noiseImage(pool);
  const Remap remap = leftRemap(rigOf(radialCamera()));
  const Image rectified = remap(raw, pool);
  for (int v = 0; v < kSize.height; ++v)
    for (int u = 0; u < kSize.width; ++u) {
      const Eigen::Vector2d from_px = remap.source_px(u, v);
      const int x = std::min(static_cast<int>(from_px.x()), kSize.width - 2),
                y = std::min(static_cast<int>(from_px.y()), kSize.height - 2);
      const double right = from_px.x() - x, down = from_px.y() - y;
      const double mean = (1 - down) * ((1 - right) * raw.at(x, y) + right * raw.at(x + 1, y)) +
                          down * ((1 - right) * raw.at(x, y + 1) + right * raw.at(x + 1, y + 1));
      ASSERT_EQ(rectified.at(u, v), std::floor(mean + 0.5)) << u << " " << v;
    }
}

/// Digest of all bytes: it is the same on every processor.
TEST(Remap, BitsAreTheSameInEveryBuild) {
  ImagePool pool;
  std::uint64_t digest = 1469598103934665603U;
  for (const LensCamera& camera : {radialCamera(), equidistantCamera()}) {
    const Image rectified = leftRemap(rigOf(camera))(noiseImage(pool), pool);
    for (int v = 0; v < kSize.height; ++v)
      for (int u = 0; u < kSize.width; ++u) digest = (digest ^ rectified.at(u, v)) * 1099511628211U;
  }
  EXPECT_EQ(digest, 8830233462395679101U);
}

/// A wall of bars as a lens sees it: their edges, bent in the raw image, must be straight afterwards.
TEST(Remap, StraightEdgesOfADistortedImageBecomeStraight) {
  const Rig rig = rigOf(radialCamera());
  const Rectification pair = rectificationOf(rig, kSize);
  constexpr double kBarHeight = 0.11;  // at distance one
  ImagePool pool;
  Image raw = pool.acquire(kSize.width, kSize.height);
  const LensModel lens(rig.left);
  for (int v = 0; v < kSize.height; ++v)
    for (int u = 0; u < kSize.width; ++u) {
      const Eigen::Vector3d ray = pair.R_left * lens.rayThrough(Eigen::Vector2d(u, v)).value();
      const double phase = std::cos(2 * M_PI * ray.y() / ray.z() / kBarHeight);
      raw.mutableRow(v)[u] = static_cast<std::uint8_t>(std::lround(127.5 + 100 * phase));
    }
  const Image rectified = Remap(rig.left, pair.R_left, pair.camera, kSize)(raw, pool);
  int raw_bend = 0, most_bend = 0;
  for (int v = 0; v < kSize.height; ++v) {
    const auto [low, high] = std::minmax_element(rectified.row(v), rectified.row(v) + kSize.width);
    most_bend = std::max(most_bend, *high - *low);
    const auto [raw_low, raw_high] = std::minmax_element(raw.row(v), raw.row(v) + kSize.width);
    raw_bend = std::max(raw_bend, *raw_high - *raw_low);
  }
  EXPECT_GT(raw_bend, 150);
  EXPECT_LE(most_bend, 4);  // 100 levels * 2 pi / 25 px = 25 levels per px: less than 0.15 px, most of it interpolation
}

TEST(Remap, WhatTheCameraDidNotSeeIsToldAndShowsItsEdge) {
  ImagePool pool;
  Image raw = pool.acquire(kSize.width, kSize.height);
  for (int v = 0; v < kSize.height; ++v) std::fill_n(raw.mutableRow(v), kSize.width, std::uint8_t{90});
  const Rig rig = rigOf(radialCamera());
  Rectification pair = rectificationOf(rig, kSize);
  pair.camera.fx_px /= 2;
  pair.camera.fy_px /= 2;
  const Remap remap(rig.left, pair.R_left, pair.camera, kSize);
  EXPECT_GT(remap.shareOutside(), 0.5);
  const Image rectified = remap(raw, pool);
  for (int v = 0; v < kSize.height; ++v)
    EXPECT_TRUE(std::all_of(rectified.row(v), rectified.row(v) + kSize.width, [](int level) { return level == 90; }));
}

TEST(Remap, WithoutDistortionAndRotationImagesStayAsTheyAreAtAnyWidth) {
  ImagePool pool;
  for (const int width : {16, 31, 32, 33, 100}) {
    const ImageSize size{width, 17};
    const LensCamera camera{.fx_px = 50, .fy_px = 50, .cx_px = 7, .cy_px = 8};
    const StereoCamera target{.fx_px = 50,
                              .fy_px = 50,
                              .cx_px = 7,
                              .cy_px = 8,
                              .baseline_m = 0.1,
                              .width_px = size.width,
                              .height_px = size.height};
    const Image raw = noiseImage(pool, size);
    const Image same = Remap(camera, Eigen::Matrix3d::Identity(), target, size)(raw, pool);
    for (int v = 0; v < size.height; ++v)
      EXPECT_TRUE(std::equal(raw.row(v), raw.row(v) + width, same.row(v))) << width << " " << v;
  }
}

}  // namespace
}  // namespace motorcade
