#pragma once

#include <cstdint>
#include <vector>

#include "core/image.hpp"
#include "frontend/shape/census.hpp"

namespace motorcade {

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
  /// Through every pixel of the window, in one direction: `count` of them side by side, each of `steps` pixels.
  struct Paths {
    int count, steps;
    std::ptrdiff_t first, between_paths, between_steps;  // pixels of the window
  };
  void fillCosts();
  void aggregate();
  void sumAlong(const Paths& paths);
  void stepAlongPath(std::uint8_t* path, std::uint8_t* least, std::size_t pixel);
  void chooseOfRight(int row);
  void choose(DisparityMap& map);
  /// In the mirrored rows of the right image, where the least disparity of a column of the window is.
  int inRight(int column) const { return right_width_ - 1 - (window_.u0 + column - range_.least_px - right_u0_); }

  PixelWindow window_;
  Range range_{};
  int right_u0_ = 0, right_width_ = 0;      // columns of the right image that are compared
  std::size_t lanes_ = 0;                   // bytes per pixel: disparities, and those that make the vectors full
  Census left_, right_;                     // of the window; of the same rows of the right image, mirrored
  std::vector<std::uint8_t> costs_, sums_;  // per pixel and disparity
  std::vector<std::uint8_t> beyond_;        // per disparity: kFar where the range has ended
  std::vector<std::uint8_t> paths_, least_of_path_;
  std::vector<std::uint8_t> least_of_right_, best_of_right_;
};

}  // namespace motorcade
