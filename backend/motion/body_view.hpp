#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "backend/motion/camera_path.hpp"
#include "backend/motion/point_set_fit.hpp"
#include "core/messages.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Points of a body in one frame, and its pose: estimated, or expected until it is.
struct BodyView {
  FrameId frame;
  std::span<const PointMeasurement> points;  // ordered by point
  double disparity_offset_px = 0;            // to be added to the measured disparities
  SE3 T_cam_body;
};

/// Fewer points determine no pose.
constexpr std::size_t kLeastPoints = 3;

/// Expected pose with the deviations of a vehicle's pose one frame later [m, rad; x ahead, y left, z up]. Points say
/// more unless they are few, far away, or in line.
ExpectedPose looselyExpected(const SE3& T_cam_body);

/// Pixel and disparity with the offset added.
Eigen::Vector3d correctedUvd_px(const PointMeasurement& measured, double disparity_offset_px);

/// A point triangulated in a view, in the body's frame.
struct TriangulatedPoint {
  Eigen::Vector3d p_body;
  Eigen::Matrix3d covariance;  // of its triangulation: the view's pose is taken as it is
};
/// Triangulates a point; empty without a positive disparity.
std::optional<TriangulatedPoint> triangulate(const StereoCamera& camera, const BodyView& view,
                                             const PointMeasurement& point);

/// Measures how a body moved from one view to another: the points of the first, triangulated, are fitted to what the
/// second saw. Uses the points of both for which `uses` holds. Empty when they are too few or give no pose, or when the
/// camera's path does not reach back to the first. The covariance has the errors of both views and of the odometry
/// between.
std::optional<ObjectObservation::Motion> motionBetween(const StereoCamera& camera, const BodyView& before,
                                                       const BodyView& now, const CameraPath& path,
                                                       const std::function<bool(PointId)>& uses);

}  // namespace motorcade
