#pragma once

#include <map>
#include <optional>

#include "core/messages.hpp"

namespace motorcade {

/// The camera's path by odometry over the last frames, enough for observations from before an object's confirmation.
class CameraPath {
 public:
  struct Camera {
    Timestamp stamp;
    SE3 T_world_cam, T_previous_now;
    Matrix6d odometry_covariance;
    Matrix6d pose_covariance;  // of T_world_cam by right perturbation, the steps taken as independent
  };

  /// Adds a frame, in order. A motion that is not finite is taken as standing still.
  void add(const FrameMeasurements& measurements);
  /// Returns null for a frame that is gone or was never added.
  const Camera* find(FrameId frame) const;
  /// Covariance of T_cam(since)_cam(now) by right perturbation, the steps taken as independent; empty when the path
  /// does not reach so far back.
  std::optional<Matrix6d> covarianceSince(FrameId since, FrameId now) const;

 private:
  std::map<FrameId, Camera> cameras_;
};

}  // namespace motorcade
