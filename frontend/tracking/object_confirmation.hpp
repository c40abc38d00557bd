#pragma once

#include <vector>

#include "core/messages.hpp"
#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// Decides when a tentative object has shown that it is a vehicle on the move.
class ObjectConfirmation {
 public:
  struct Params {
    int confirm_observations = 3;    // frames with a measurement before an object is reported,
    double confirm_speed_mps = 1.0;  // its speed,
    double confirm_travel_m = 0.5;   // and its way since it was spawned
  };
  ObjectConfirmation(const Params& params, const StereoCamera& camera) : params_(params), camera_(camera) {}

  /// Decides by the newest observation of the object's backlog, which is of this frame. `reported` are this frame's
  /// observations of other objects.
  bool operator()(const TrackedObject& object, const std::vector<ObjectObservation>& reported,
                  const GroundPlane& ground) const;

 private:
  bool movesSurely(const ObjectKinematics& kinematics, double sigmas) const;
  bool walksSurely(const TrackedObject& object, double traveled_m, const GroundPlane& ground) const;

  bool looksThrough(const ObjectObservation& few, const ObjectObservation& many) const;

  Params params_;
  StereoCamera camera_;
};

std::vector<Parameter> parametersOf(ObjectConfirmation::Params& params);

}  // namespace motorcade
