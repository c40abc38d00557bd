#pragma once

#include <cstdint>
#include <span>

#include "core/image.hpp"

/// Comparison of windows at whole pixels: the kernel of the searches for disparities.
namespace motorcade {

struct WindowSize {
  int columns, rows;  // odd
  bool operator==(const WindowSize&) const = default;
};
/// Window sizes in use, for images of half size, where a window shows twice as much of the scene, and for full size.
/// The compiler knows them, so that all loops have a fixed length.
inline constexpr WindowSize kHalfSizeWindow{9, 5}, kFullSizeWindow{11, 7};

inline constexpr int kMaxWindowCosts = 512;

/// The pixels of an image around (u, v).
struct Window {
  const Image& image;
  int u, v;
  WindowSize size;  // kHalfSizeWindow or kFullSizeWindow

  bool insideImage() const {
    const int half_columns = size.columns / 2, half_rows = size.rows / 2;
    return v >= half_rows && v + half_rows < image.height() && u >= half_columns && u + half_columns < image.width();
  }
};

/// Sums of absolute differences between a window and those around (other_u + i, other_v) of another image, for each i
/// below costs.size(), at most kMaxWindowCosts. The difference of the means (to a whole gray level) is taken out first.
/// All windows lie inside their images. Blocks of sixteen costs are left out if their bit in `blocks` is not set.
void windowDifferences(const Window& window, const Image& other, int other_u, int other_v,
                       std::span<std::uint16_t> costs, std::uint32_t blocks = ~std::uint32_t{0});

}  // namespace motorcade
