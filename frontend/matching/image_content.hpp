#pragma once

#include <algorithm>

#include "frontend/messages.hpp"

/// Measures of an image's content that tell whether the image is of use.
namespace motorcade {

/// Texture of all corners together; in a blurred image it is a fraction of that in the sharp one.
inline double textureOf(const Features& features) {
  double sum = 0;
  for (const Corner& corner : features.corners) sum += corner.score;
  return sum;
}

/// True when two images of the same size are equal to the bit.
inline bool sameContent(const Image& a, const Image& b) {
  for (int y = 0; y < a.height(); ++y)
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) return false;
  return true;
}

}  // namespace motorcade
