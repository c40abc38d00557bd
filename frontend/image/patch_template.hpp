#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "core/image.hpp"

namespace motorcade {

inline constexpr int kMaxPatchWindow_px = 13;

/// How a patch may deform beside its shift: a small change of scale in time, a slope of the disparity between the eyes.
enum class PatchDeformation { kScale, kSlope };

/// A patch with what its alignment needs: its appearance a = (I - mean) / |I - mean| and the derivatives D of I by the
/// parameters (kScale: u, v, log scale; kSlope: u, u per row, u per column), made orthogonal to 1 and a. For the raw
/// intensities J of another image the Gauss-Newton step is H^-1 sum(D J) / gain with H = sum(D D') + prior, whatever
/// the gain and bias of J. The planes are kept in integers, before norm, mean and orthogonality, which the sums over
/// them are given afterwards.
struct PatchTemplate {
  PatchTemplate() {}  // leaves the planes as they are: they are filled at once
  static constexpr int kStride = 16;
  static constexpr float kOtherUnit = 1.0F / 8;  // gray levels that a word of the other image's samples counts
  using Plane = std::array<std::int16_t, kStride * kMaxPatchWindow_px>;  // zero to the right of the window
  alignas(32) Plane appearance;
  alignas(32) std::array<Plane, 3> descent;
  int window_px = 0;
  int mean = 0;           // of the samples in the window, 1/64 gray level
  float norm = 0;         // of I - mean
  float off_grid_px = 0;  // where the point lies, to the right of the grid's place at which it was sampled
  // sum(a J) = unit * sum(appearance J) - mean * sum(J), and the same for sum(D J), less what lies along a.
  float appearance_unit = 0, appearance_mean = 0;
  Eigen::Vector3f descent_units, descent_mean, descent_along;
  Eigen::Vector3f prior;  // information of the deformations' prior around zero
  Eigen::Matrix3f inverse_hessian;
};

inline constexpr float kMinTemplateScale = 0.6F;

/// Empty without the texture that the shift needs, or when the point lies outside the image. With a `scale` the
/// template shows the image that much enlarged around the point: how a point that was seen from afar looks now; empty
/// below kMinTemplateScale.
std::optional<PatchTemplate> makeTemplate(const Image& image, float u_px, float v_px, int window_px,
                                          PatchDeformation deformation, float scale = 1);

}  // namespace motorcade
