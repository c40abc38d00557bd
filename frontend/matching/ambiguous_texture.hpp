#pragma once

#include <Eigen/Core>

#include "core/image.hpp"

namespace motorcade {

/// A point that was followed from one image to another, forwards or backwards in time.
struct FollowedPatch {
  const Image &from, &to;
  Eigen::Vector2d from_px, to_px;
};

/// True when the patch is also found where a point at rest would be, at `at_rest_px` of the image `to`. Ambiguous
/// texture (fences, rails, lane dashes, brick) matches consistently at a wrong position. Posts two meters apart, seen
/// from a car that drives two meters a frame, stand still in the image like a vehicle at our own speed. A vehicle shows
/// something else there. `scale` is the size of the patch at rest in `to` over that in `from`.
bool isAlsoFoundAtRest(const FollowedPatch& patch, const Eigen::Vector2d& at_rest_px, double scale);

}  // namespace motorcade
