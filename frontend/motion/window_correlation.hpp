#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/image.hpp"

/// Correlates small windows of one image with those of another, for a search over many places. Means and norms of the
/// windows are computed once.
namespace motorcade {

/// Pixels of a small window less their mean, divided by their norm.
class WindowPattern {
 public:
  static constexpr int kSide = 8, kPixels = kSide * kSide;
  static constexpr float kOne = 2048;  // what 1 is in the values: 64 products with gray levels fit into 32 bits

  /// Nearest pixels around a place, enlarged by `scale`; empty beyond the image's border and without texture.
  static std::optional<WindowPattern> sample(const Image& image, const Eigen::Vector2f& at_px, float scale);

  const std::array<std::int16_t, kPixels>& values() const { return values_; }  // row by row
  int sum() const { return sum_; }                                             // 0 but for rounding

 private:
  std::array<std::int16_t, kPixels> values_;
  int sum_ = 0;
};

/// An image whose windows can be compared with patterns.
class CorrelatedImage {
 public:
  explicit CorrelatedImage(const Image& image);

  /// Correlation, from -1 to 1, of the pattern with the window at the nearest whole pixel; 0 where that has no texture.
  /// Empty where it reaches beyond the border.
  std::optional<float> correlation(const WindowPattern& pattern, const Eigen::Vector2f& at_px) const;

 private:
  struct Window {
    float mean = 0, inverse_norm = 0;  // of its pixels less their mean; 0 without texture
  };
  int columns_, rows_;  // of windows
  std::size_t stride_;
  std::vector<std::int16_t> pixels_;
  std::vector<Window> windows_;  // by their first pixel
};

}  // namespace motorcade
