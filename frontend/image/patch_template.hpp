#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "core/image.hpp"
namespace motorcade {

using FourFloats = float __attribute__((vector_size(16)));
inline FourFloats allFour(float value) { return FourFloats{value, value, value, value}; }

inline constexpr int kPatchWindow_px = 11;  // side of the patches of flow and stereo, odd
inline constexpr int kMaxPatchWindow_px = 13;

/// Deformation of a patch beside its shift: a small change of scale from frame to frame, or a slope of the disparity
/// between left and right image.
enum class PatchDeformation { kScale, kSlope };

/// A patch prepared for alignment: its appearance a = (I - mean) / |I - mean| and the derivatives D of I with respect
/// to the parameters (kScale: u, v, log scale; kSlope: u, u per row, u per column), made orthogonal to 1 and a. For the
/// raw intensities J of another image the Gauss-Newton step is H^-1 sum(D J) / gain with H = sum(D D') + prior,
/// whatever the gain and bias of J. The planes hold integers that are neither normalized, free of their mean nor
/// orthogonal: the sums over them are corrected for that.
struct PatchTemplate {
  PatchTemplate() {}  // NOLINT(modernize-use-equals-default): that would clear the planes, which are filled at once
  static constexpr int kStride = 16;
  static constexpr float kOtherUnit = 1.0F / 8;  // gray levels that a word of the other image's samples counts
  using Plane = std::array<std::int16_t, kStride * kMaxPatchWindow_px>;  // zero to the right of the window
  alignas(32) Plane appearance;
  alignas(32) std::array<Plane, 3> descent;
  int window_px = 0;
  int mean = 0;           // of the samples in the window, 1/64 gray level
  float norm = 0;         // of I - mean
  float off_grid_px = 0;  // from the column at which the patch was sampled, in 1/64 px, to the point
  // Of a and the three of D: sum(a J) = unit * sum(appearance J) - mean * sum(J), the same for sum(D J), less its
  // component along a.
  FourFloats units, means, along;
  Eigen::Vector3f prior;                      // information of the deformations' prior around zero; none for u
  std::array<FourFloats, 3> inverse_hessian;  // its columns, each behind a zero
};

inline constexpr float kMinTemplateScale = 0.6F;  // eight samples then span less than 15 px (`SampleColumns`)

/// Makes a template. Empty when the patch lacks the texture that its shift needs, or the point lies outside the image.
/// `scale` enlarges the image around the point, as a point first seen from afar looks now; empty below
/// kMinTemplateScale.
std::optional<PatchTemplate> makeTemplate(const Image& image, float u_px, float v_px, int window_px,
                                          PatchDeformation deformation, float scale = 1);

}  // namespace motorcade
