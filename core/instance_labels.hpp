#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace motorcade {

/// Labels of the left image's pixels from somebody else's segmentation: one number for the pixels of one body, 0 where
/// nothing is told. Numbers mean nothing beyond their image. Labels are evidence and no more: they may be late by some
/// frames, cover what is beside their body, or lie.
class InstanceLabels {
 public:
  InstanceLabels() = default;
  InstanceLabels(int width, int height) { resize(width, height); }
  /// Reserves memory for so many pixels; up to there, `resize` does not use the heap.
  void reserve(int width, int height) {
    labels_.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  }
  /// Leaves the content undefined, but 0 where the size grows.
  void resize(int width, int height) {
    width_ = width, height_ = height;
    labels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  const std::uint16_t* row(int y) const { return labels_.data() + static_cast<std::ptrdiff_t>(y) * width_; }
  std::uint16_t* mutableRow(int y) { return labels_.data() + static_cast<std::ptrdiff_t>(y) * width_; }
  /// Label of the pixel whose square holds the point (whole numbers are the middles of pixels); 0 outside the image.
  std::uint16_t at(double u_px, double v_px) const {
    const double x = u_px + 0.5, y = v_px + 0.5;
    return x >= 0 && y >= 0 && x < width_ && y < height_ ? row(static_cast<int>(y))[static_cast<int>(x)] : 0;
  }

 private:
  int width_ = 0, height_ = 0;
  std::vector<std::uint16_t> labels_;  // row by row
};

}  // namespace motorcade
