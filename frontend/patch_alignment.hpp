#pragma once

#include <array>
#include <optional>

#include "frontend/messages.hpp"

/// Alignment of small square patches to a fraction of a pixel, whatever their gain and bias: the kernel of flow and stereo.
namespace motorcade {

inline constexpr int kMaxPatchWindow_px = 15;

struct PatchParams {
  int window_px = 11;         // side of the patch, odd
  int max_iterations = 10;    // of Gauss-Newton, per level
  double max_step_px = 0.02;  // converged below this
  double max_shift_px = 4;    // from the guess, per level; further is a failure
  double min_ncc = 0.8;       // normalised cross-correlation at the solution
  double sigma_floor_px = 0.1;
};

/// A patch with what its alignment needs: a(x) = (I(x) - mean) / |I - mean| over the window and the descent directions
///   D(x) = grad I(x), made orthogonal to 1 and a,   so that a step is H^-1 sum(D J) / gain for raw intensities J of the other image.
struct PatchTemplate {
  static constexpr int kStride = 16;
  using Plane = std::array<float, kStride * kMaxPatchWindow_px>;
  alignas(32) Plane appearance, descent_u, descent_v;
  int window_px = 0;
  float norm = 0;                      // |I - mean| of the template
  float h_uu = 0, h_uv = 0, h_vv = 0;  // H = sum(D D')
};

/// Empty without texture in both directions, or when the window leaves the image by more than the clamped border covers.
std::optional<PatchTemplate> makeTemplate(const Image& image, float u_px, float v_px, int window_px);

struct AlignedPatch {
  float u_px = 0, v_px = 0;
  float ncc = 0;
  float sigma_px = 0;  // standard deviation of each coordinate, from the residual and H; the larger axis, never below the floor
};

/// Finds the template in `image` near a guess by inverse-compositional Gauss-Newton (Baker, Matthews 2004).
/// Empty when it runs away, does not fit or leaves the image.
std::optional<AlignedPatch> alignPatch(const PatchTemplate& patch, const Image& image, float u_guess_px, float v_guess_px,
                                       const PatchParams& params);

/// The same from coarse to fine: follows the point (u, v) of `from` into `to`, both in full-size pixels, from `first_level` down to 0.
std::optional<AlignedPatch> alignPatch(const ImagePyramid& from, float u_px, float v_px, const ImagePyramid& to, float u_guess_px,
                                       float v_guess_px, int first_level, const PatchParams& params);

/// Normalised cross-correlation of the template with `image` at a position, -1 outside the image.
float correlation(const PatchTemplate& patch, const Image& image, float u_px, float v_px);

struct DisparityParams {
  int window_px = 11;
  double search_radius_px = 3;  // whole-pixel search around the prediction; 0 goes straight to the refinement
  int max_iterations = 5;
  double min_ncc = 0.8;
  double sigma_floor_px = 0.1;
  double max_sigma_px = 1;
};

/// Disparity of the left pixel (u, v), which may lie between pixels: whole-pixel search around the prediction by the sum of absolute
/// differences, then 1-D Gauss-Newton on the intensities of both patches (a parabola through the sums would pull to whole pixels).
/// Empty when the window leaves an image, nothing is similar enough, or the predicted sigma is too large. About 1 us.
std::optional<StereoMatch> refineDisparity(const Image& left, const Image& right, double u_px, double v_px, double predicted_disparity_px,
                                           const DisparityParams& params = {});

}  // namespace motorcade
