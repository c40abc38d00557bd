#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// How a point's image motion between two frames departs from what the camera's motion explains for a point at rest
/// (Kundu, Krishna, Sivaswamy, "Moving object detection by multi-view geometric techniques from a single camera mounted
/// robot", 2009).
struct GeometricResidual {
  /// Distance from the epipolar line, in standard deviations.
  double epipolar_sigmas = 0;
  /// How far the flow vector lies outside its bound along the epipolar line, in px beyond the bound; 0 inside.
  /// The bound is the stretch of the line that the depths within `depth_sigmas` of the stereo depth project to.
  double flow_bound_px = 0;
};

/// `uvd_then` with `sigma_then` was seen before, pixel `uv_now` now; T_now_then is the camera's motion between.
/// Empty when the camera hardly moved (no epipolar line) or the point projects behind it.
std::optional<GeometricResidual> geometricResidual(const StereoCamera& camera, const Eigen::Vector3d& uvd_then_px,
                                                   const Eigen::Vector3d& sigma_then_px,
                                                   const Eigen::Vector2d& uv_now_px, double sigma_now_px,
                                                   const SE3& T_now_then, double depth_sigmas = 3.0);

}  // namespace motorcade
