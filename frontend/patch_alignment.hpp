#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "frontend/messages.hpp"

/// Alignment of small square patches to a fraction of a pixel, whatever their gain and bias: the kernel of flow and stereo.
/// A patch may be up to half outside its image, whose border pixels are then repeated.
namespace motorcade {

inline constexpr int kMaxPatchWindow_px = 13;

struct PatchParams {
  int window_px = 11;         // side of the patch, odd
  int max_iterations = 12;    // of Gauss-Newton, per level
  double max_step_px = 0.02;  // converged below this
  double max_shift_px = 4;    // from the guess, per level; further is a failure
  double min_ncc = 0.65;      // normalised cross-correlation at the solution
  double sigma_floor_px = 0.12;
};

/// How a patch may deform beside its shift: a small change of scale in time, a slope of the disparity between the eyes.
enum class PatchDeformation { kScale, kSlope };

/// A patch with what its alignment needs: its appearance a = (I - mean) / |I - mean| and the derivatives D of I by the parameters
/// (kScale: u, v, log scale; kSlope: u, u per row, u per column), made orthogonal to 1 and a. For the raw intensities J of another image
/// the Gauss-Newton step is H^-1 sum(D J) / gain with H = sum(D D') + prior, whatever the gain and bias of J.
/// The planes are kept in integers, before norm, mean and orthogonality, which the sums over them are given afterwards.
struct PatchTemplate {
  PatchTemplate() {}  // leaves the planes as they are: they are filled at once
  static constexpr int kStride = 16;
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

/// Empty without the texture that the shift needs, or when the point lies outside the image. With a `scale` the template shows the image
/// that much enlarged around the point: how a point that was seen from afar looks now; empty below kMinTemplateScale.
std::optional<PatchTemplate> makeTemplate(const Image& image, float u_px, float v_px, int window_px, PatchDeformation deformation,
                                          float scale = 1);

struct AlignedPatch {
  float u_px = 0, v_px = 0;
  float ncc = 0;         // with the deformation taken into account
  float log_growth = 0;  // log scale of what `image` shows over the template's
  float sigma_px = 0;    // standard deviation of each coordinate, from residual and H; of the worse one, never below the floor
};

/// Finds a kScale template in `image` near a guess by inverse-compositional Gauss-Newton (Baker, Matthews 2004).
/// Empty when it runs away, does not fit or leaves the image.
std::optional<AlignedPatch> alignPatch(const PatchTemplate& patch, const Image& image, float u_guess_px, float v_guess_px,
                                       const PatchParams& params);

/// The same from coarse to fine: follows the point (u, v) of `from` into `to`, both in full-size pixels, from `first_level` down to 0.
std::optional<AlignedPatch> alignPatch(const ImagePyramid& from, float u_px, float v_px, const ImagePyramid& to, float u_guess_px,
                                       float v_guess_px, int first_level, const PatchParams& params);

struct DisparityParams {
  int window_px = 11;
  double search_radius_px = 3;  // whole-pixel search around the prediction; 0 goes straight to the refinement
  int max_iterations = 8;
  double min_ncc = 0.65;
  double sigma_floor_px = 0.12;
  double max_sigma_px = 1;
};

/// Disparity of the left pixel (u, v), which may lie between pixels: whole-pixel search around the prediction by sums of absolute
/// differences, then 1-D Gauss-Newton on the intensities of both patches (a parabola through the sums would pull to whole pixels), which
/// follows the slope of the surface. Empty when the window leaves an image, nothing is similar enough, the disparity is not positive or its
/// predicted sigma is too large.
std::optional<StereoMatch> refineDisparity(const Image& left, const Image& right, double u_px, double v_px, double predicted_disparity_px,
                                           const DisparityParams& params = {});

}  // namespace motorcade
