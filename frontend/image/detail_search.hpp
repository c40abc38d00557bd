#pragma once

#include <cstdint>
#include <optional>

#include "core/image.hpp"
#include "frontend/image/window_differences.hpp"

/// Search for a window along a row at whole pixels, for all disparities. It compares sums of differences of windows,
/// free of their means; a quicker comparison tells first which sums are worth computing.
namespace motorcade {

/// An image with its detail, which can be compared byte by byte whatever the gain and bias of the two cameras.
struct DetailedImage {
  Image image;
  /// Brightness of each pixel minus the mean of the 9x5 pixels around it, plus 128, from 0 to 255. Beyond its border an
  /// image repeats its last pixels.
  Image detail;
};
DetailedImage withDetail(const Image& image, ImagePool& pool);

struct ColumnRange {
  int first, last;
};

/// Column of `to` in a range around which a window of `kHalfSizeWindow` looks most like that around (u, v) of `from`,
/// which lies inside. It has the least of the `windowDifferences`, of equal ones the first. Empty where another one,
/// more than two columns away, is nearly as small: their ratio exceeds `max_ratio`. At most kMaxWindowCosts columns are
/// searched.
std::optional<int> searchRow(const DetailedImage& from, int u, int v, const DetailedImage& to, ColumnRange range,
                             double max_ratio);

}  // namespace motorcade
