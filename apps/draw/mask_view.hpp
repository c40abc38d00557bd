#pragma once

#include "apps/draw/marks.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {

/// Tints each object's pixels of a mask in the color of its track, with a crisp rim.
void paintMask(Sheet& sheet, const Gray16Image& mask);

}  // namespace motorcade
