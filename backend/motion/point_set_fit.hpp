#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// A point in a rigid frame `ref` (the camera of an earlier frame, or a body), seen by the stereo camera now.
struct SeenPoint {
  Eigen::Vector3d p_ref;
  Eigen::Matrix3d covariance_ref;  // of p_ref [m^2]
  Eigen::Vector3d uvd_px, sigma_px;
};

/// Expected pose of the frame `ref` and its deviations, which close the directions that points leave open.
struct ExpectedPose {
  SE3 T_cam_ref;
  Vector6d sigma;  // [m, rad], right perturbation
};

struct PointSetFit {
  SE3 T_cam_ref;
  Matrix6d covariance;  // right perturbation; from the errors of both, the points in `ref` and what is seen of them now
};

/// Pose of a rigid set of points by robust Gauss-Newton (Cauchy):
///   min over T of sum rho(r' S^-1 r) + prior, r = uvd - project(T p_ref), S = diag(sigma^2) + J C_ref J',
///   J = d project(T p_ref) / d p_ref.
/// To first order this is the most likely pose given both sides' errors, the points' true positions being unknowns.
/// Empty when the problem is singular, or a point that counts would lie behind the camera.
std::optional<PointSetFit> fitPointSet(const StereoCamera& camera, std::span<const SeenPoint> points,
                                       const ExpectedPose& expected);

}  // namespace motorcade
