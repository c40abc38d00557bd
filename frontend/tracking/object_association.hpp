#pragma once

#include <vector>

#include "core/se3.hpp"
#include "frontend/messages.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Global nearest neighbor: which moving segment is which object, one to one at least total cost, in the world frame.
class ObjectAssociation {
 public:
  struct Params {
    double gate_chi2 = 16.0;         // position and velocity over the ground, 4 degrees of freedom
    double centroid_spread_m = 1.5;  // standard deviation of a segment's centroid about the body's origin
    double velocity_spread_mps = 1.0;
    double shared_points_bonus = 20.0;  // cost taken off when all points of the segment are the object's already
    double claimed_share = 0.3;  // a segment with this share of an object's points belongs to it whatever the distance
  };
  explicit ObjectAssociation(const Params& params) : params_(params) {}

  /// For each segment of `scene` the index of its object, or -1: not moving, or new. Segments beyond the one-to-one
  /// match that consist of an object's points are given to it as well.
  std::vector<int> operator()(const std::vector<TrackedObject>& objects, const SceneMotion& scene,
                              const SE3& T_world_cam) const;

 private:
  double cost(const TrackedObject& object, const SceneMotion& scene, const Segment& segment,
              const SE3& T_world_cam) const;

  Params params_;
};

/// Share of a segment's points that an object holds.
double sharedPoints(const TrackedObject& object, const SceneMotion& scene, const Segment& segment);

}  // namespace motorcade
