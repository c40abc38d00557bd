#pragma once

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Does the image's border cut an object with these points off? At the left, so does the border of what the right
/// camera sees.
bool isCutOff(const Box& points, const SE3& T_cam_body, const StereoCamera& camera);

/// How much of a cuboid's width is where both cameras see it.
double shareInImages(const ObjectBox& box, const SE3& T_cam_body, const StereoCamera& camera);

/// Drops rows of what has left the images: for the most part, where it is but predicted; wholly, where points still go
/// along with it, which are those of another vehicle then.
void dropLeft(FrameEstimate& frame, const StereoCamera& camera);

}  // namespace motorcade
