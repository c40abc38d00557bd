#pragma once

#include <cstdint>
#include <vector>

#include "core/se3.hpp"
#include "core/timestamp.hpp"

namespace motorcade {

/// The camera's recent path in the front-end's own odometry, for relating observations of different frames.
class CameraTrail {
 public:
  /// Number of frames remembered, the newest included: a second at ten frames a second. A point's track spans no more.
  static constexpr int kCapacity = 10;

  struct Step {
    std::int64_t step;  // number of the frame, counted from 0 over all frames that were added
    Timestamp stamp;
    SE3 T_world_cam;
  };
  /// Appends a frame and forgets the oldest one beyond the capacity.
  void add(Timestamp stamp, const SE3& T_seen_now);
  bool empty() const { return steps_.empty(); }
  const Step& newest() const { return steps_.back(); }

  /// Pose of a past frame's camera seen from the newest, T_then_now, and the time from now to then (not positive).
  struct Relation {
    SE3 T_then_now;
    double dt_s;
  };
  /// The relation to a frame, or null when it was forgotten.
  const Relation* find(std::int64_t step) const;

 private:
  std::vector<Step> steps_;
  std::vector<Relation> relations_;  // of the same frames; the last is the identity
};

}  // namespace motorcade
