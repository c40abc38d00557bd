#pragma once

#include <vector>

#include "core/parameters.hpp"
#include "core/pixel_mask.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Finds points worth following: local maxima of the smaller eigenvalue of the gradient's second moments (Shi, Tomasi
/// 1994), spread over a grid of cells. Every cell gives its best corner before any cell gives its second best, so that
/// dark and distant cars keep their share beside strong texture. Stateless; safe to call from several threads.
class CornerDetector {
 public:
  struct Params {
    int max_corners = 1500;
    /// Root of the smaller eigenvalue in gray levels per pixel, a mean over the window of the smoothed image.
    double min_score = 1.5;
  };
  static constexpr int kCell_px = 24;        // side of a cell
  static constexpr int kMinDistance_px = 4;  // no better corner lies within this many columns and rows

  explicit CornerDetector(const Params& params);

  /// Returns corners ordered by cell, row by row, the strongest of a cell first, at whole pixels. The least score is
  /// `score_share` of the parameter. No corner lies on an ignored pixel.
  std::vector<Corner> operator()(const Image& image, double score_share = 1, const PixelMask* ignored = nullptr) const;

 private:
  Params params_;
};

std::vector<Parameter> parametersOf(CornerDetector::Params& params);

}  // namespace motorcade
