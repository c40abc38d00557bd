#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "frontend/shape/census.hpp"
#include "frontend/shape/path_costs.hpp"

namespace motorcade {

/// Place of the least value of a parabola through three neighboring values, in -1/2 ... 1/2.
inline float parabolaOffset(int before, int least, int after) {
  const int curvature = before + after - 2 * least;
  return curvature > 0 ? 0.5F * static_cast<float>(before - after) / static_cast<float>(curvature) : 0.0F;
}

/// Disparities of every pixel of a window [px of the images given]; `kNone` where the two images do not agree on one.
struct DisparityMap {
  static constexpr float kNone = -1;
  PixelWindow window;
  std::vector<float> disparity_px;  // row by row
  float at(int column, int row) const { return disparity_px[static_cast<std::size_t>(row) * window.width + column]; }
};

/// Dense disparities of a window of a rectified pair by semi-global matching (Hirschmüller, "Stereo processing by
/// semiglobal matching and mutual information", 2008). Costs are Hamming distances of census transforms, summed along
/// four directions; a disparity stands where the search from right to left agrees. It is cheap because the window and
/// the range are small. Keeps its buffers; one call at a time.
class DenseDisparity {
 public:
  struct Range {
    int least_px, count;  // disparities least_px ... least_px + count - 1
  };
  /// Computes the disparities. The window is cut to the part that the left image has, the range to disparities from
  /// zero on.
  DisparityMap operator()(const Image& left, const Image& right, PixelWindow window, Range range);

 private:
  void fillCosts();
  void markUnknown(std::uint8_t* costs_of_row, int disparity) const;
  void choose(int row, DisparityMap& map);
  void gatherRow(int row);
  /// Column of the right image for a column of the window at the least disparity, counted from right_u0_.
  int inRight(int column) const { return window_.u0 + column - range_.least_px - right_u0_; }
  /// Index of a row's sums of a disparity at the first column of the window.
  std::ptrdiff_t inSums(int disparity) const { return disparity * stride_of_sums_ + room_; }

  PixelWindow window_;
  Range range_{};
  int right_u0_ = 0, right_width_ = 0;  // columns of the right image that are compared
  std::ptrdiff_t room_ = 0, stride_of_sums_ = 0;
  Census left_, right_;  // of the window; of the same rows of the right image
  DisparityBlocks costs_, sums_;
  PathCosts path_costs_;
  std::vector<std::uint8_t> sums_of_row_;  // per disparity and column, with room before and after the window
  std::vector<std::uint8_t> beyond_;       // per column: all bits set where the window has ended
  std::vector<std::uint8_t> best_, best_of_right_;
};

/// Refines the disparities of some cells in the same images at `scale` times their size, a power of two. Each is
/// searched anew within a pixel or two of what it is there. Where nothing fits best, it stays.
void refineDisparities(const Image& left, const Image& right, int scale, std::span<const int> cells, DisparityMap& map);

}  // namespace motorcade
