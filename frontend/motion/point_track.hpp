#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/ids.hpp"
#include "core/se3.hpp"
#include "core/timestamp.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// One observation of a scene point in a stereo pair.
struct PointObservation {
  std::int64_t step = 0;  // number of the processed frame, as counted by CameraTrail
  Eigen::Vector3f uvd_px;
  Eigen::Vector3f sigma_px;
};

/// What the front-end remembers of a scene point: its latest observations and what was last found out about it.
struct PointTrack {
  static constexpr int kCapacity = 10;

  PointId point;
  int count = 0;                                         // observations held, at most kCapacity
  std::array<PointObservation, kCapacity> observations;  // oldest first
  std::optional<SceneFlow> flow;                         // of the newest observation
  std::optional<Eigen::Vector3d> p_static_cam;  // position of a point at rest, in the camera of the newest observation
  Eigen::Matrix3d static_covariance = Eigen::Matrix3d::Identity();
  PointLabel label = PointLabel::kUnknown;
  int repeats = 0;  // counts up with every frame in which it was found at rest as well, down with the others

  const PointObservation& newest() const { return observations[count - 1]; }
  /// The observation of a frame, or null.
  const PointObservation* find(std::int64_t step) const;
  void add(const PointObservation& observation);
  /// Forgets all but the newest `keep` observations.
  void shorten(int keep);
};

/// The camera's recent path in the front-end's own odometry, for relating observations of different frames.
class CameraTrail {
 public:
  struct Step {
    std::int64_t step;
    Timestamp stamp;
    SE3 T_world_cam;
  };
  /// Appends a frame; keeps as many as a track can hold.
  void add(Timestamp stamp, const SE3& T_previous_now);
  bool empty() const { return steps_.empty(); }
  const Step& newest() const { return steps_.back(); }

  /// Where a past frame's camera was, seen from the newest: T_then_now, and the time from now to then (not positive).
  struct Relation {
    SE3 T_then_now;
    double dt_s;
  };
  /// Relations of the newest frames, oldest first; the last is the identity.
  const std::vector<Relation>& relations() const { return relations_; }
  /// The relation to a frame, or null when it was forgotten.
  const Relation* find(std::int64_t step) const;

 private:
  std::vector<Step> steps_;
  std::vector<Relation> relations_;
};

}  // namespace motorcade
