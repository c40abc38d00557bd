#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/stereo_camera.hpp"
#include "frontend/shape/object_sight.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// A point of an object's surface, as an outline's cell and its disparity have it.
struct SurfacePoint {
  Eigen::Vector3d direction_body;  // of the cell's ray, one meter of depth long
  double depth_m, noise_m;         // its standard deviation
  double height_m;                 // above the road
};

/// Some of an outline's, well above the road.
std::vector<SurfacePoint> surfacePoints(const LevelDisparities& disparities, const Outline& outline,
                                        const ObjectView& view, const StereoCamera& camera);

/// What one frame's outline and its surface points say of the object's faces, linearized at `view.box`: the distances
/// of points on faces in view, the bounds of the outline where neither the image nor something nearer cuts it, and the
/// road below.
FaceInformation measureFaces(const LevelDisparities& disparities, const Outline& outline,
                             std::span<const SurfacePoint> surface, const ObjectView& view, const StereoCamera& camera);

/// The same by the outline that a label has, too, where there is one: of small bodies by that alone, as it is the more
/// exact by far, of others by both in equal parts. All labels may err to one side, as those of a camera beside this
/// one.
FaceInformation measureFaces(const Sight& seen, std::span<const SurfacePoint> surface, const ObjectView& view,
                             const StereoCamera& camera);

}  // namespace motorcade
