#pragma once

#include <cstddef>
#include <vector>

#include "frontend/messages.hpp"

namespace motorcade {

/// A point seen in both images of a pair that need not be rectified [px].
struct EpipolarMatch {
  double u_left_px = 0, v_left_px = 0, u_right_px = 0, v_right_px = 0;

  double rowDifference_px() const { return v_right_px - v_left_px; }
  double disparity_px() const { return u_left_px - u_right_px; }
};

/// A pair that is ready to be matched, with points of its left image.
struct PreparedPair {
  ImagePyramid left, right;
  std::vector<Corner> corners;
};

/// Takes the corners of the left image at half size: they are as good, and found at a quarter of the cost. An image
/// with far less contrast is given the other's.
PreparedPair preparePair(Image left, Image right, ImagePool& pool);

/// Matches at most `points` corners of the left image, spread over it, with the right one. The search covers 20 rows
/// above and below and either sign of the disparity, so that images that are exchanged, turned or shifted are matched,
/// too. Matches that are ambiguous, or are not found again from right to left, are left out. Both pyramids need at
/// least three levels, or nothing is found.
std::vector<EpipolarMatch> matchUnrectified(const ImagePyramid& left, const ImagePyramid& right,
                                            const std::vector<Corner>& corners, std::size_t points);

}  // namespace motorcade
