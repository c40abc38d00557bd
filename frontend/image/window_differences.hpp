#pragma once

#include <cstdint>
#include <span>

#include "core/image.hpp"

/// Comparison of windows to whole pixels: the kernel of searches for disparities.
namespace motorcade {

struct WindowSize {
  int columns = 11, rows = 7;  // odd
  bool operator==(const WindowSize&) const = default;
};
inline constexpr int kMaxWindowCosts = 512;
inline constexpr int kMaxWindowColumns = 17, kMaxWindowRows = 15;
inline constexpr int kMaxWindowPixels = 128;  // sums of differences then fit 15 bits and a sign
constexpr bool fits(WindowSize window) {
  return window.columns <= kMaxWindowColumns && window.rows <= kMaxWindowRows &&
         window.columns * window.rows <= kMaxWindowPixels;
}

/// Sums of absolute differences, means removed to a whole gray level, between the window around (u, v) of `image` and
/// those around (other_u
/// + i, other_v) of `other`, i < costs.size() <= kMaxWindowCosts. All windows lie inside their images.
void windowDifferences(const Image& image, int u, int v, const Image& other, int other_u, int other_v,
                       WindowSize window, std::span<std::uint16_t> costs);

}  // namespace motorcade
