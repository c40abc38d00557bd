#pragma once

#include <optional>
#include <span>

#include "frontend/image/patch_template.hpp"
#include "frontend/messages.hpp"

/// Alignment of small square patches to a fraction of a pixel, whatever their gain and bias: the kernel of flow and
/// stereo. A patch may be up to half outside its image, whose border pixels are then repeated.
namespace motorcade {

struct PatchParams {
  int window_px = 11;         // side of the patch, odd
  int max_iterations = 12;    // of Gauss-Newton, per level
  double max_step_px = 0.02;  // converged below this
  double max_shift_px = 4;    // from the guess, per level; further is a failure
  double min_ncc = 0.65;      // normalized cross-correlation at the solution
  double sigma_floor_px = 0.12;
};

struct AlignedPatch {
  float u_px = 0, v_px = 0;
  float ncc = 0;         // with the deformation taken into account
  float log_growth = 0;  // log scale of what `image` shows over the template's
  float sigma_px =
      0;  // standard deviation of each coordinate, from residual and H; of the worse one, never below the floor
};

/// Finds a kScale template in `image` near a guess by inverse-compositional Gauss-Newton (Baker, Matthews 2004).
/// Empty when it runs away, does not fit or leaves the image.
std::optional<AlignedPatch> alignPatch(const PatchTemplate& patch, const Image& image, float u_guess_px,
                                       float v_guess_px, const PatchParams& params);

/// The same from coarse to fine: follows the point (u, v) of `from` into `to`, both in full-size pixels, from
/// `first_level` down to 0.
std::optional<AlignedPatch> alignPatch(const ImagePyramid& from, float u_px, float v_px, const ImagePyramid& to,
                                       float u_guess_px, float v_guess_px, int first_level, const PatchParams& params);

struct DisparityParams {
  int window_px = 11;
  double search_radius_px = 3;  // whole-pixel search around the prediction; 0 goes straight to the refinement
  int max_iterations = 8;
  double min_ncc = 0.65;
  double sigma_floor_px = 0.12;
  double max_sigma_px = 1;
};

/// Disparity of the left pixel (u, v), which may lie between pixels: whole-pixel search around the prediction by sums
/// of absolute differences, then 1-D Gauss-Newton on the intensities of both patches (a parabola through the sums would
/// pull to whole pixels), which follows the slope of the surface. Empty when the window leaves an image, nothing is
/// similar enough, the disparity is not positive or its predicted sigma is too large.
std::optional<StereoMatch> refineDisparity(const Image& left, const Image& right, double u_px, double v_px,
                                           double predicted_disparity_px, const DisparityParams& params = {});

}  // namespace motorcade
