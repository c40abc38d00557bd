#pragma once

#include <span>

#include "frontend/shape/dense_disparity.hpp"

namespace motorcade {

/// Refines the disparities of some cells in the same images at `scale` times their size, a power of two. Each is
/// searched anew within a pixel or two of what it is there. Where nothing fits best, it stays.
void refineDisparities(const Image& left, const Image& right, int scale, std::span<const int> cells, DisparityMap& map);

}  // namespace motorcade
