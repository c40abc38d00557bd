#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "apps/watch/epipolar_matching.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// The median, the upper one of two in the middle; 0 of none.
inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Causes of row differences in a pair, to first order. x, y are the left pixel's normalized coordinates, d is the
/// disparity and x_r = x - d / f. The row in the right image less that in the left one is
///   offset (1 + y^2) + f roll x + f zoom y + f yaw x y + (lift + ahead y) d + f k1 y (x_r^2 - x^2)
enum class RowError {
  kOffset,  // px, at the principal point: pitch between the cameras, or another crop
  kRoll,    // rad, about the optical axis, the right image clockwise
  kZoom,    // relative difference of the focal lengths
  kYaw,     // rad
  kLift,    // of the right camera upwards, over the baseline
  kAhead,   // of the right camera, over the baseline
  kBarrel,  // k1, the radial distortion of both images that was not taken out
};
inline constexpr std::size_t kRowErrors = 7;

struct RowErrorEstimate {
  double value = 0, sigma = 0;
  double effect_px = 0;  // on the rows, root mean square over the image; for kBarrel, the displacement in a corner
};

struct PairGeometry {
  std::array<RowErrorEstimate, kRowErrors> errors;
  double rms_px = 0;          // of row differences, as they are
  double remaining_px = 0;    // once the errors above are taken out
  double explained_px = 0;    // of the errors above, all together, at the matches; root mean square
  double agreeing_share = 0;  // of the matches that follow them
  std::size_t matches = 0;

  const RowErrorEstimate& operator[](RowError error) const { return errors[static_cast<std::size_t>(error)]; }
};

/// Robust least squares (Cauchy weights) over the matches of several pairs of one rig. Errors that the matches do not
/// show stay at zero, with their prior standard deviation.
PairGeometry estimatePairGeometry(std::span<const EpipolarMatch> matches, const StereoCamera& camera);

/// The row in the right image less that in the left one, of a point at this left pixel and disparity.
double predictedRowError_px(const PairGeometry& geometry, const StereoCamera& camera, double u_left_px,
                            double v_left_px, double disparity_px);

/// Root mean square of the row differences as they are; 0 of none.
double rowRms_px(std::span<const EpipolarMatch> matches);

/// Matches whose row differences lie within a pixel of their median.
std::size_t matchesInRow(std::span<const EpipolarMatch> matches);

}  // namespace motorcade
