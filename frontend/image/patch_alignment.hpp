#pragma once

#include <algorithm>
#include <optional>

#include <Eigen/Core>

#include "frontend/image/patch_template.hpp"
#include "frontend/messages.hpp"

/// Aligns small square patches to a fraction of a pixel, whatever their gain and bias: the kernel of flow and stereo.
/// Up to half of a patch may lie outside its image, whose border pixels are then repeated.
namespace motorcade {

/// Least standard deviation of an alignment. It stands for errors that the residual does not show.
inline constexpr double kPatchSigmaFloor_px = 0.12;

struct PatchParams {
  double max_step_px = 0.02;  // converged below this
  double max_shift_px = 4;    // from the guess, per level; farther is a failure
  double min_ncc = 0.65;      // normalized cross-correlation at the solution
};

struct AlignedPatch {
  float u_px = 0, v_px = 0;
  float ncc = 0;         // with the deformation taken into account
  float log_growth = 0;  // log of the patch's scale in `image` over that of the template
  float sigma_px = 0;    // standard deviation of the worse coordinate, from residual and H; never below the floor
};

/// Finds a kScale template in `image` near a guess by inverse-compositional Gauss-Newton (Baker, Matthews 2004).
/// Empty when the alignment diverges, the patches do not fit, or the patch leaves the image.
std::optional<AlignedPatch> alignPatch(const PatchTemplate& patch, const Image& image, const Eigen::Vector2f& guess_px,
                                       const PatchParams& params);

/// Follows a point of `from` into `to` from coarse to fine, from `first_level` down to 0. Point and guess are in
/// full-size pixels.
std::optional<AlignedPatch> alignPatch(const ImagePyramid& from, const Eigen::Vector2f& point_px,
                                       const ImagePyramid& to, const Eigen::Vector2f& guess_px, int first_level,
                                       const PatchParams& params);

/// Asks for the pixels of a patch around (u, v) to be brought into the cache.
inline void prefetchPatch(const Image& image, float u_px, float v_px, int window_px) {
  const int half = window_px / 2 + 1, u = static_cast<int>(u_px), v = static_cast<int>(v_px);
  const int left = std::clamp(u - half, 0, image.width() - 1), right = std::clamp(u + half, 0, image.width() - 1);
  const int bottom = std::min(v + half + 1, image.height() - 1);
  for (int y = std::max(v - half, 0); y <= bottom; ++y) {
    __builtin_prefetch(image.row(y) + left);
    __builtin_prefetch(image.row(y) + right);
    asm volatile("");  // or GCC takes the loop to be without effect
  }
}

struct DisparityParams {
  double search_radius_px = 3;  // of the whole-pixel search around the prediction; with 0 there is only the refinement
};

/// Disparity of the left point (u, v), which may lie between pixels. A whole-pixel search around the prediction by sums
/// of absolute differences comes first, then 1-D Gauss-Newton on the intensities of both patches. It follows the slope
/// of the surface; a parabola through the sums would pull to whole pixels. Empty when the patch leaves an image,
/// nothing is similar enough, the disparity is not positive or its predicted sigma is too large.
std::optional<StereoMatch> refineDisparity(const Image& left, const Image& right, double u_px, double v_px,
                                           double predicted_disparity_px, const DisparityParams& params = {});

}  // namespace motorcade
