#pragma once

#include <optional>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/motion/camera_trail.hpp"
#include "frontend/motion/point_track.hpp"

namespace motorcade {

/// Departure of a point's image motion between two frames from what the camera's motion explains for a point at rest
/// (Kundu, Krishna, Sivaswamy, "Moving object detection by multi-view geometric techniques from a single camera mounted
/// robot", 2009).
struct GeometricResidual {
  /// Distance from the epipolar line, in standard deviations.
  double epipolar_sigmas = 0;
  /// Distance of the flow vector from its bound along the epipolar line, in px beyond the bound; 0 inside. The bound is
  /// the stretch of the line to which depths within three standard deviations of the stereo depth project.
  double flow_bound_px = 0;
};

/// The residual of a point under the camera's motion. Empty when the camera hardly moved (no epipolar line) or the
/// point projects behind it.
std::optional<GeometricResidual> geometricResidual(const StereoCamera& camera, const StereoCorrespondence& point,
                                                   const SE3& T_now_then);

/// True when the newest observation of a track breaks the epipolar constraint or the flow-vector bound of a point at
/// rest; false for tracks that are too short to tell.
bool violatesGeometry(const StereoCamera& camera, const PointTrack& track, const CameraTrail& trail);

/// True when the velocity of a point differs from rest by more than its own noise and the errors that it shares with
/// the points around it explain. Such a point proves motion along the epipolar line, too, where the bound above is
/// wide.
bool movesSurely(const StereoCamera& camera, const SceneFlow& flow, double camera_speed_mps);

}  // namespace motorcade
