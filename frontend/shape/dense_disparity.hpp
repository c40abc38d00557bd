#pragma once

#include <cstdint>
#include <vector>

#include "core/image.hpp"

namespace motorcade {

/// A rectangle of an image: columns u0 ... u0 + width - 1, rows v0 ... v0 + height - 1.
struct PixelWindow {
  int u0 = 0, v0 = 0, width = 0, height = 0;
  bool empty() const { return width <= 0 || height <= 0; }
  int area() const { return empty() ? 0 : width * height; }
};

/// Disparities of every pixel of a window [px of the images given]; `kNone` where the two images do not agree on one.
struct DisparityMap {
  static constexpr float kNone = -1;
  PixelWindow window;
  std::vector<float> disparity_px;  // row by row
  float at(int column, int row) const { return disparity_px[static_cast<std::size_t>(row) * window.width + column]; }
};

/// Dense disparities of a window of a rectified pair by semi-global matching (Hirschmüller, "Stereo processing by
/// semiglobal matching and mutual information", 2008): costs are Hamming distances of census transforms, summed along
/// four directions; a disparity stands where the search from right to left agrees. Cheap because the window and the
/// range are small. Keeps its buffers; one call at a time.
class DenseDisparity {
 public:
  struct Range {
    int least_px, count;  // disparities least_px ... least_px + count - 1
  };
  /// The window is cut to where the left image has it; the range to disparities from zero on.
  DisparityMap operator()(const Image& left, const Image& right, PixelWindow window, Range range);

 private:
  void fillCosts(const PixelWindow& window, const Range& range);
  void aggregate(const PixelWindow& window, const Range& range);
  void sumAlongRow(const PixelWindow& window, const Range& range, int row, bool backward);
  void sumAlongColumns(const PixelWindow& window, const Range& range, bool backward);
  void beginPaths(std::size_t paths, std::size_t count);
  void chooseOfRight(const PixelWindow& window, const Range& range, int row);
  void choose(const Image& left, DisparityMap& map, const Range& range);

  std::vector<std::uint32_t> left_, right_;  // census of the window; of the same rows of the right image
  int right_u0_ = 0, right_width_ = 0;       // columns that `right_` holds
  std::vector<std::uint8_t> costs_;          // per pixel and disparity
  std::vector<std::uint16_t> sums_, path_, next_;
  std::vector<int> best_of_right_;
  std::vector<std::uint16_t> least_of_right_;
};

/// Makes disparities more exact in the same images at `scale` times their size, a power of two: each is searched anew
/// within a pixel or two of what it is there. Where nothing fits best, it stays.
void refineDisparities(const Image& left, const Image& right, int scale, DisparityMap& map);

}  // namespace motorcade
