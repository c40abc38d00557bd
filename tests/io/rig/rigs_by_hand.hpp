#pragma once

#include <string>

#include <Eigen/Geometry>

#include "io/rig/rectification.hpp"

/// Rigs that the tests of this room share.
namespace motorcade::test {

inline constexpr ImageSize kSize{376, 240};

/// A camera about as the left one of EuRoC's rig at half its resolution.
inline LensCamera radialCamera() {
  return {.fx_px = 229.3,
          .fy_px = 228.6,
          .cx_px = 183.6,
          .cy_px = 124.2,
          .distortion = Distortion::kRadialTangential,
          .coefficients = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}};
}

inline LensCamera equidistantCamera() {
  return {.fx_px = 160,
          .fy_px = 161,
          .cx_px = 186,
          .cy_px = 121,
          .distortion = Distortion::kEquidistant,
          .coefficients = {0.0034, 0.0007, -0.002, 0.0002}};
}

/// The right camera stands 0.11 m to the right, a little off in all directions.
inline Rig rigOf(const LensCamera& camera) {
  LensCamera right = camera;
  right.cx_px += 6;
  right.fy_px -= 0.7;
  const SE3 T_left_right(expSO3({0.01, -0.012, 0.008}), {0.11, 0.0008, -0.0012});
  return {.file = "by hand", .left = camera, .right = right, .T_right_left = T_left_right.inverse()};
}

}  // namespace motorcade::test
