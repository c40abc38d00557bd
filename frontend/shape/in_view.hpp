#pragma once

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// True when the image's border cuts off an object with these points. At the left, so does the border of what the right
/// camera sees.
bool isCutOff(const Box& points, const SE3& T_cam_body, const StereoCamera& camera);

/// Share of a cuboid's width that both cameras see.
double shareInImages(const ObjectBox& box, const SE3& T_cam_body, const StereoCamera& camera);

/// Drops rows of objects that have left the images. A predicted one has left when less than half of it is seen. One
/// that still has points has left when nothing of its cuboid is seen: then the points are those of another vehicle.
void dropLeft(FrameEstimate& frame, const StereoCamera& camera);

}  // namespace motorcade
