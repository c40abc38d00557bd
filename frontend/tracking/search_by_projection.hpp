#pragma once

#include <vector>

#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Looks for a body's points in another stereo pair where its predicted pose T_cam_body puts them, by the patches
/// around them in the pair where they were measured. Alignment makes up for small errors of the prediction. It serves
/// points that are followed no more, or were not followed yet. Points whose patch is not found, in the left image or at
/// about the predicted disparity in the right one, are left out; the others must still be checked against each other,
/// by a rigid body's pose. `disparity_offset_px` is that of the other pair.
std::vector<ScenePoint> searchByProjection(const TrackedObject& body, const MeasuredPoints& measured,
                                           const Features& other, const SE3& T_cam_body, double disparity_offset_px,
                                           const StereoCamera& camera);

/// True for a followed point, false for a patch that `samplePatches` placed.
inline bool isFollowed(PointId point) { return point.value >= 0; }

/// Patches at most, about: in a large box they are farther apart.
inline constexpr int kMostPatches = 64;

/// Patches of a part of the image that lie at about a disparity: evidence of a body on which corners are few. Numbered
/// -1, -2, ...
std::vector<ScenePoint> samplePatches(const Features& features, const Box& box, double disparity_px,
                                      double disparity_offset_px, int most = kMostPatches);

/// Share of a box's patches that lie at about a disparity.
double shareAtDepth(const Features& features, const Box& box, double disparity_px, double disparity_offset_px,
                    int most = kMostPatches);

/// Patches between the measured points of a body, at about their disparity.
std::vector<ScenePoint> samplePatches(const MeasuredPoints& measured, double disparity_offset_px);

}  // namespace motorcade
