#pragma once

#include "core/stereo_camera.hpp"
#include "frontend/tracking/tracked_object.hpp"

namespace motorcade {

/// An ordinary vehicle: what may be one body without further evidence.
struct VehicleSize {
  double length_m = 6.0, width_m = 2.8, height_m = 3.2;
  bool holds(const Eigen::AlignedBox3d& box, double slack_m) const {
    return (box.sizes().array() < Eigen::Array3d(length_m, width_m, height_m) + slack_m).all();
  }
};

/// Decides which scene points join an object: those inside its extent that move with it.
class PointAdoption {
 public:
  struct Params {
    double margin_m = 0.8;            // beyond the points known so far
    double depth_noise_sigmas = 2.0;  // by which the margin grows
    double max_length_m = 14.0;       // of the body: it grows to this by and by
    VehicleSize vehicle;              // within it, points of a segment that was matched to the object need no neighbors
    double fits_chi2 = 9.0;           // 3 degrees of freedom
    double not_static_chi2 = 16.0;
    double min_speed_mps = 1.0;  // slower objects cannot be told from the background by motion
  };
  PointAdoption(const Params& params, const StereoCamera& camera) : params_(params), camera_(camera) {}

  /// Adds the points of `segment` (or, without one, of the whole scene) that fit. `taken[i]` marks points of some
  /// object; kept up to date.
  void operator()(TrackedObject& object, const SceneMotion& scene, const Segment* segment, const SE3& T_world_cam,
                  std::vector<bool>& taken) const;

  /// Puts a point into the object's frame, with the covariance that its disparity gives.
  BodyPoint toBody(const TrackedObject& object, const ScenePoint& point) const;

 private:
  bool movesWith(const TrackedObject& object, const ScenePoint& point, const SE3& T_world_cam) const;
  bool couldBeOneBody(const Eigen::AlignedBox3d& box, double slack_m) const;

  Params params_;
  StereoCamera camera_;
};

}  // namespace motorcade
