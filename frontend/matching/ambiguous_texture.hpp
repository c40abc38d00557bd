#pragma once

#include <Eigen/Core>

#include "core/image.hpp"

namespace motorcade {

/// Repeated texture (fences, rails, lane dashes, brick) matches consistently at a wrong place: posts two meters apart,
/// seen from a car that drives two meters a frame, stand still in the image, as a vehicle at our own speed does. Such a
/// point looks the same where it would be if it were at rest; a vehicle shows something else there.
struct RepeatedTextureParams {
  double min_ncc = 0.8;          // of the patch at rest
  double max_prediction_px = 3;  // between the place predicted at rest and the place found
  double min_separation_px =
      5;  // between that and where the point was followed from: nearer places show the same thing anyway
};

/// Is the patch around `now_px` also found in the image before at the place from which a point at rest would have come,
/// and not only where it was followed from? `scale` is the size of the patch at rest before over that now. Works
/// forwards as well, with the roles exchanged.
bool isFoundAtRestToo(const Image& now, const Eigen::Vector2d& now_px, const Image& before,
                      const Eigen::Vector2d& at_rest_px, const Eigen::Vector2d& followed_from_px, double scale,
                      const RepeatedTextureParams& params);

}  // namespace motorcade
