#pragma once

#include <array>
#include <cstddef>
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

/// Census transform of a window of an image (Zabih and Woodfill, "Non-parametric local transforms for computing visual
/// correspondence", 1994): which of the 24 pixels around are darker, in three planes of eight. Outside the image, its
/// border counts. Keeps its buffers.
class Census {
 public:
  static constexpr int kBytes = 3, kMostDifferent = 24;

  /// Computes the planes; `room` bytes before and after each row may be read.
  void compute(const Image& image, const PixelWindow& window, int room);
  const std::uint8_t* row(int byte, int v) const { return planes_[byte].data() + at(v); }
  /// Brightest minus darkest of every other pixel around [gray levels].
  const std::uint8_t* texture(int v) const { return texture_.data() + at(v); }

 private:
  std::size_t at(int v) const { return static_cast<std::size_t>(v) * stride_ + room_; }

  std::size_t stride_ = 0, room_ = 0, stride_around_ = 0;
  std::array<std::vector<std::uint8_t>, kBytes> planes_;
  std::vector<std::uint8_t> texture_, around_;  // the window's, and its pixels with those around it
};

}  // namespace motorcade
