#pragma once

#include <array>
#include <span>

#include "backend/joint/bundle_factor.hpp"

namespace motorcade {

/// An observation of a landmark that is known where the earlier camera is.
struct ViewOfKnown {
  KnownLandmark landmark;
  Eigen::Vector3d uvd_px, inverse_sigma;  // of the later view
};

/// What observations of known landmarks say of the camera's newest pose relative to an earlier one. Each is a
/// measurement whose noise is the view's and the landmark's own:
///   H = sum(J' (1 + B P B')^-1 J)
/// with J by the motion and B by the landmark, both whitened by the view's noise, and the landmark's covariance P. The
/// shake of the newest frame is eliminated; what else the errors of landmarks have in common is left out, and the
/// disparity offset is taken as known.
EliminatedLandmarks alignToKnown(const StereoCamera& camera, const LandmarkNoise& noise,
                                 std::span<const ViewOfKnown> views, const std::array<SE3, 2>& T_cam_world,
                                 double offset_px);

}  // namespace motorcade
