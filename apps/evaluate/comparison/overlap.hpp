#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/messages.hpp"
#include "io/truth/ground_truth.hpp"

/// Overlap of boxes in the image, as seen from above and in space.
namespace motorcade {

/// Common area in the image [px^2].
double overlapArea(const Box& a, const Box& b);
/// Intersection over union of two boxes in the image.
double intersectionOverUnion(const Box& a, const Box& b);

/// A cuboid as seen from above: the corners of its footprint in order, in any right-handed plane.
using Footprint = std::vector<Eigen::Vector2d>;
double areaOf(const Footprint& convex);
/// Common area of two convex footprints with counterclockwise corners.
double overlapArea(const Footprint& a, const Footprint& b);

/// A cuboid that stands upright in the camera's frame.
struct UprightCuboid {
  Footprint corners;               // (x, z) [m]
  double top_m = 0, bottom_m = 0;  // y, which points down
  Eigen::Vector2d middle, ahead;   // (x, z)
  Eigen::Vector3d size_m;          // length, width, height
};
UprightCuboid labeledCuboid(const ObjectTruth& truth);
/// Cuboid of an object that has one, as seen from the estimated camera.
UprightCuboid estimatedCuboid(const SE3& T_world_cam, const ObjectEstimate& object);

/// Intersection over union of the footprints, and of the volumes.
double footprintIou(const UprightCuboid& a, const UprightCuboid& b);
double volumeIou(const UprightCuboid& a, const UprightCuboid& b);

}  // namespace motorcade
