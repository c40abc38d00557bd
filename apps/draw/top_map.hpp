#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "apps/canvas/rectangle.hpp"
#include "apps/recorded/recorded_drive.hpp"

namespace motorcade {

/// Maps the camera's frame to a picture from above in which the camera heads right.
struct TopMap {
  double px_per_m = 1;
  Eigen::Vector2d origin_px = Eigen::Vector2d::Zero();  // of the camera

  Eigen::Vector2d operator()(const Eigen::Vector3d& p_cam) const {
    return origin_px + px_per_m * Eigen::Vector2d(p_cam.z(), p_cam.x());
  }
};

/// Chooses a map that shows all objects with their motion, near movers of the truth, and some road behind and ahead, as
/// large as `area` allows. The scale changes slowly from frame to frame, so that moving pictures stay calm.
TopMap topMapOf(const RecordedDrive& drive, std::size_t frame, const Rectangle& area);

}  // namespace motorcade
