#pragma once

#include <span>

#include "frontend/shape/dense_disparity.hpp"

namespace motorcade {

/// Makes the disparities of some cells more exact in the same images at `scale` times their size, a power of two: each
/// is searched anew within a pixel or two of what it is there. Where nothing fits best, it stays.
void refineDisparities(const Image& left, const Image& right, int scale, std::span<const int> cells, DisparityMap& map);

}  // namespace motorcade
