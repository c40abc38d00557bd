#include "io/rig/lens_camera.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/io/rig/rigs_by_hand.hpp"

namespace motorcade {
namespace {

using test::equidistantCamera;
using test::kSize;
using test::radialCamera;

TEST(LensModel, RayThroughAPixelIsImagedAtThatPixel) {
  constexpr double kRounding_px = 1e-9;
  for (const LensCamera& camera : {radialCamera(), equidistantCamera()}) {
    const LensModel lens(camera);
    for (int v = 0; v < kSize.height; v += 13)
      for (int u = 0; u < kSize.width; u += 17) {
        const auto ray = lens.rayThrough(Eigen::Vector2d(u, v));
        ASSERT_TRUE(ray) << u << " " << v;
        const auto back_px = lens.project(*ray);
        ASSERT_TRUE(back_px);
        EXPECT_LT((*back_px - Eigen::Vector2d(u, v)).norm(), kRounding_px);
      }
  }
}

/// The formulae of OpenCV's documentation, written out.
TEST(LensModel, RadialTangentialPixelIsThatOfTheFormula) {
  LensCamera camera = radialCamera();
  camera.coefficients = {-0.3, 0.12, 0.002, -0.003, -0.02, 0.01, 0.004, -0.003};
  const double x = 0.31, y = -0.22, r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
  const double radial = (1 - 0.3 * r2 + 0.12 * r4 - 0.02 * r6) / (1 + 0.01 * r2 + 0.004 * r4 - 0.003 * r6);
  const double xd = x * radial + 2 * 0.002 * x * y - 0.003 * (r2 + 2 * x * x);
  const double yd = y * radial + 0.002 * (r2 + 2 * y * y) - 2 * 0.003 * x * y;
  const auto pixel_px = LensModel(camera).project({2 * x, 2 * y, 2});
  ASSERT_TRUE(pixel_px);
  EXPECT_NEAR(pixel_px->x(), camera.fx_px * xd + camera.cx_px, 1e-10);
  EXPECT_NEAR(pixel_px->y(), camera.fy_px * yd + camera.cy_px, 1e-10);
}

TEST(LensModel, EquidistantPixelIsThatOfTheFormulaAlsoBeyondARightAngle) {
  const LensCamera camera = equidistantCamera();
  for (const double angle_rad : {0.3, 1.2, 1.7}) {
    const double squared = angle_rad * angle_rad;
    const double distance = angle_rad * (1 + 0.0034 * squared + 0.0007 * std::pow(squared, 2) -
                                         0.002 * std::pow(squared, 3) + 0.0002 * std::pow(squared, 4));
    const auto pixel_px =
        LensModel(camera).project({0.6 * std::sin(angle_rad), 0.8 * std::sin(angle_rad), std::cos(angle_rad)});
    ASSERT_TRUE(pixel_px) << angle_rad;
    EXPECT_NEAR(pixel_px->x(), camera.fx_px * 0.6 * distance + camera.cx_px, 1e-10);
    EXPECT_NEAR(pixel_px->y(), camera.fy_px * 0.8 * distance + camera.cy_px, 1e-10);
  }
}

TEST(LensModel, RaysFromBehindOrThatWouldFoldBackAreNotSeen) {
  const LensModel lens(radialCamera());
  EXPECT_FALSE(lens.project({0, 0, -1}));
  EXPECT_FALSE(lens.project({1, 0, 0}));
  // r (1 - 0.283 r^2 + 0.074 r^4) grows everywhere, with k2 = 0 only up to r = 1.084: what lies beyond would come back.
  LensCamera barrel = radialCamera();
  barrel.coefficients = {-0.28340811};
  const double limit = std::sqrt(1 / (3 * 0.28340811));
  EXPECT_TRUE(LensModel(barrel).project({0.99 * limit, 0, 1}));
  EXPECT_FALSE(LensModel(barrel).project({1.02 * limit, 0, 1}));
  EXPECT_FALSE(LensModel(barrel).rayThrough({barrel.cx_px + barrel.fx_px * 0.8, barrel.cy_px}));
}

}  // namespace
}  // namespace motorcade
