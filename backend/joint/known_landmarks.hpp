#pragma once

#include <array>
#include <span>

#include "backend/joint/bundle_factor.hpp"

namespace motorcade {

/// An observation of a landmark that is known in the earlier camera.
struct ViewOfKnown {
  KnownLandmark landmark;
  Eigen::Vector3d uvd_px, inverse_sigma;  // of the later view
};

/// Information of known landmarks on the camera's newest pose relative to an earlier one. Each observation is a
/// measurement whose noise is the view's and the landmark's own:
///   H = sum(J' (1 + B P B')^-1 J)
/// J is by the motion and B by the landmark, both whitened by the view's noise; P is the landmark's covariance. The
/// shake of the newest frame is eliminated. Other common errors of landmarks are left out, and the disparity offset is
/// taken as known.
EliminatedLandmarks alignToKnown(const StereoCamera& camera, const LandmarkNoise& noise,
                                 std::span<const ViewOfKnown> views, const std::array<SE3, 2>& T_cam_world,
                                 double offset_px);

}  // namespace motorcade
