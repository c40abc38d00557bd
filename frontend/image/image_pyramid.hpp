#pragma once

#include "frontend/messages.hpp"

namespace motorcade {

/// Halves an image: each pixel is the rounded mean of a 2x2 block, so that pixel (x, y) lies over (2x + 1/2, 2y + 1/2).
/// An odd last row or column is dropped.
Image halved(const Image& image, ImagePool& pool);

/// Returns the image itself and its halves, quarters, ...; fewer than `levels` when the next one would be smaller than
/// `kMinPyramidSide_px`.
ImagePyramid buildPyramid(const Image& image, int levels, ImagePool& pool);

inline constexpr int kMinPyramidSide_px = 16;

/// Coordinate of a full-size pixel in level k, and back.
inline float toLevel(float full_px, int level) { return (full_px + 0.5F) / static_cast<float>(1 << level) - 0.5F; }
inline float fromLevel(float level_px, int level) { return (level_px + 0.5F) * static_cast<float>(1 << level) - 0.5F; }

}  // namespace motorcade
