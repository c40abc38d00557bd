#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace motorcade {

/// A set of an image's pixels; empty when made without a size.
class PixelMask {
 public:
  PixelMask() = default;
  PixelMask(int width, int height) : width_(width), height_(height), inside_(std::size_t(width) * height, 0) {}

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return std::ranges::find(inside_, 1) == inside_.end(); }

  /// True for a point in the square of a pixel of the set (whole numbers are the middles of pixels); false outside the
  /// image.
  bool holds(double u_px, double v_px) const {
    const double x = u_px + 0.5, y = v_px + 0.5;
    return x >= 0 && y >= 0 && x < width_ && y < height_ && inside_[index(static_cast<int>(x), static_cast<int>(y))];
  }
  /// Adds the pixels of columns `left` up to `right` and rows `top` up to `bottom`, ends excluded, that lie in the
  /// image.
  void add(int left, int top, int right, int bottom) {
    for (int y = std::max(0, top); y < std::min(bottom, height_); ++y)
      for (int x = std::max(0, left); x < std::min(right, width_); ++x) inside_[index(x, y)] = 1;
  }

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width_ + x; }

  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> inside_;  // row by row
};

/// Null where the mask holds no pixel.
inline std::shared_ptr<const PixelMask> sharedMask(PixelMask mask) {
  return mask.empty() ? nullptr : std::make_shared<const PixelMask>(std::move(mask));
}

}  // namespace motorcade
