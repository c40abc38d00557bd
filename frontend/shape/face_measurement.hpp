#pragma once

#include "core/stereo_camera.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// What one frame's outline and its disparities say of the object's faces, linearized at `view.box`: the distances of
/// points on faces in view, the bounds of the outline where neither the image nor something nearer cuts it, and the
/// road below.
FaceInformation measureFaces(const LevelDisparities& disparities, const Outline& outline, const ObjectView& view,
                             const StereoCamera& camera);

}  // namespace motorcade
