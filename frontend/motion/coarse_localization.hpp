#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// A point at rest as it was seen last.
struct RestingPoint {
  PointId point;
  Eigen::Vector3d uvd_px;  // then
  Eigen::Vector3d p_cam;   // in the camera of then
  int observations = 1;
};

/// Range of the camera's motion between two images, about a predicted one.
struct MotionRange {
  SE3 T_then_now;                                       // predicted
  double forward_m = 0, yaw_rad = 0, pitch_rad = 0.03;  // how far it may differ from it, each way
};

/// Finds the motions within a range under which small patches around points at rest look most alike in both images, the
/// best first. It searches all distances and turns at the coarsest level of the pyramid, for when nothing is near
/// enough to be aligned. Exact to some pixels, where it is right at all. Its work grows with the
/// range in each direction and with nothing else: some of the points tell which motions are worth asking all of them.
std::vector<SE3> localizeCoarsely(std::span<const RestingPoint> points, const ImagePyramid& then,
                                  const ImagePyramid& now, const MotionRange& range, const StereoCamera& camera);

}  // namespace motorcade
