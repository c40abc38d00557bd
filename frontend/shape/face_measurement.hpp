#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/stereo_camera.hpp"
#include "frontend/shape/object_sight.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// A point of an object's surface, from an outline's cell and its disparity.
struct SurfacePoint {
  Eigen::Vector3d direction_body;  // of the cell's ray, one meter of depth long
  double depth_m, noise_m;         // its standard deviation
  double height_m;                 // above the road
};

/// Some of an outline's surface points, well above the road.
std::vector<SurfacePoint> surfacePoints(const LevelDisparities& disparities, const Outline& outline,
                                        const ObjectView& view, const StereoCamera& camera);

/// Evidence of one frame's outline and its surface points on the object's faces, linearized at `view.box`. It holds the
/// distances of points on faces in view, the road below, and the bounds of the outline, unless the image or something
/// nearer cuts it.
FaceInformation measureFaces(const LevelDisparities& disparities, const Outline& outline,
                             std::span<const SurfacePoint> surface, const ObjectView& view, const StereoCamera& camera);

/// The same, also by a label's outline where there is one. Small bodies are measured by that alone, as it is far more
/// exact, others by both in equal parts. All labels may err to one side, as those of a camera beside this one.
FaceInformation measureFaces(const Sight& seen, std::span<const SurfacePoint> surface, const ObjectView& view,
                             const StereoCamera& camera);

}  // namespace motorcade
