#pragma once

#include <algorithm>

#include "frontend/messages.hpp"

/// What an image shows, as far as it tells whether it is of use.
namespace motorcade {

/// Of all corners together; of a blurred image it is a fraction of that of the sharp one.
inline double textureOf(const Features& features) {
  double sum = 0;
  for (const Corner& corner : features.corners) sum += corner.score;
  return sum;
}

/// To the bit; both have the same size.
inline bool sameContent(const Image& a, const Image& b) {
  for (int y = 0; y < a.height(); ++y)
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) return false;
  return true;
}

}  // namespace motorcade
