#pragma once

#include <vector>

#include "frontend/messages.hpp"

namespace motorcade {

/// A point seen in both images of a pair that need not be rectified [px].
struct EpipolarMatch {
  double u_left_px = 0, v_left_px = 0, u_right_px = 0, v_right_px = 0;

  double rowDifference_px() const { return v_right_px - v_left_px; }
  double disparity_px() const { return u_left_px - u_right_px; }
};

/// Matches some corners of the left image with the right one, up to 20 rows above or below and whatever the sign of the
/// disparity: images that are exchanged, turned or shifted are matched too. What is not unique, or not found again from
/// right to left, is left out. Both pyramids have three levels or more, or nothing is found.
std::vector<EpipolarMatch> matchUnrectified(const ImagePyramid& left, const ImagePyramid& right,
                                            const std::vector<Corner>& corners);

}  // namespace motorcade
