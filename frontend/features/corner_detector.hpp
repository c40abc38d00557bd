#pragma once

#include <vector>

#include "core/parameters.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Finds points worth following: local maxima of the smaller eigenvalue of the gradient's second moments (Shi, Tomasi
/// 1994), spread over a grid of cells. Every cell gives its best corner before any cell gives its second best, so that
/// dark and distant cars keep their share beside strong texture. Stateless; safe to call from several threads.
class CornerDetector {
 public:
  struct Params {
    int max_corners = 1500;
    int cell_px = 24;
    int max_per_cell = 6;
    double min_score =
        1.5;  // gray levels per pixel: root of the smaller eigenvalue's mean over the window, in the smoothed image
    double min_score_over_grain =
        0.5;  // grain: standard deviation of the pixel noise that the neighborhood would need to look as rough
    int border_px = 8;
    int min_distance_px = 4;  // no better corner within this many columns and rows
  };
  explicit CornerDetector(const Params& params);

  /// Corners ordered by cell, row by row, the strongest of a cell first. Their coordinates are whole pixels.
  std::vector<Corner> operator()(const Image& image) const;

 private:
  Params params_;
};

std::vector<Parameter> parametersOf(CornerDetector::Params& params);

}  // namespace motorcade
