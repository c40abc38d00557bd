#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "core/ids.hpp"
#include "frontend/messages.hpp"
#include "frontend/motion/camera_trail.hpp"

namespace motorcade {

/// One observation of a scene point in a stereo pair.
struct PointObservation {
  std::int64_t step = 0;  // number of the frame, as counted by CameraTrail
  Eigen::Vector3f uvd_px;
  Eigen::Vector3f sigma_px;
};

/// A point seen in two stereo pairs some frames apart.
struct StereoCorrespondence {
  Eigen::Vector3d uvd_then_px, sigma_then_px;
  Eigen::Vector3d uvd_now_px, sigma_now_px;
};

/// Memory of a scene point: its latest observations and the last findings about it.
struct PointTrack {
  static constexpr int kCapacity = CameraTrail::kCapacity;

  PointId point;
  int count = 0;                                         // observations held, at most kCapacity
  std::array<PointObservation, kCapacity> observations;  // oldest first
  std::optional<SceneFlow> flow;                         // of the newest observation
  std::optional<Eigen::Vector3d> p_static_cam;  // position of a point at rest, in the camera of the newest observation
  Eigen::Matrix3d static_covariance = Eigen::Matrix3d::Identity();
  PointLabel label = PointLabel::kUnknown;
  int ambiguity = 0;  // counts up with every frame in which it was also found at rest, down with the others

  const PointObservation& oldest() const { return observations.front(); }
  const PointObservation& newest() const { return observations[count - 1]; }
  /// The observation of a frame, or null.
  const PointObservation* find(std::int64_t step) const;
  /// Correspondence from one of its observations to the newest.
  StereoCorrespondence sinceThen(const PointObservation& then) const;
  /// Becomes the track of a new point, without an observation.
  void restart(PointId new_point);
  /// Appends an observation and forgets the oldest one beyond the capacity.
  void add(const PointObservation& observation);
  /// Becomes `before` with another observation. The findings about its motion hold no longer.
  void extend(const PointTrack& before, const PointObservation& observation);
};

}  // namespace motorcade
