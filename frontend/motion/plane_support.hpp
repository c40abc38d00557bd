#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "frontend/messages.hpp"

namespace motorcade {

/// A point that may lie on the road.
struct LowPoint {
  Eigen::Vector3d p_cam;
  double tolerance_m;  // of its height above the plane
};

/// Index of the plane with most support, the first of several. A point near a plane supports it by a truncated
/// quadratic; points below speak against it.
std::size_t mostSupported(std::span<const GroundPlane> planes, std::span<const LowPoint> points);

}  // namespace motorcade
