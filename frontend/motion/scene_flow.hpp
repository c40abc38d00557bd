#pragma once

#include <optional>
#include <vector>

#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/motion/camera_trail.hpp"
#include "frontend/motion/point_track.hpp"

namespace motorcade {

/// Scene flow: motion of single points relative to the world, from their observations over several frames. Both models
/// are fitted to the observations (u, v, d) themselves, through the camera's path: their noise is unbiased at any
/// range, that of differences of triangulated points is not. Stateless.
class SceneFlowEstimator {
 public:
  struct Params {
    int max_observations = 8;      // the newest; half as many where they do not fit a constant velocity
    int min_observations = 3;      // fewer tell nothing about motion
    double max_speed_mps = 60;     // standard deviation of the velocity's prior
    double pose_jitter_px = 0.15;  // image error of the camera's path, added to each observation
    /// Standard deviation of the acceleration that the moving model leaves out. Old observations count less, where it
    /// would show.
    double acceleration_mps2 = 1;
    double huber_sigmas = 2.5;  // where the loss turns linear, in units of the whitened residual norm
    int iterations = 3;
  };
  SceneFlowEstimator(const Params& params, const StereoCamera& camera)
      : params_(requireValid(params)), camera_(camera) {}

  /// A point at rest: min over p of sum |uvd_k - project(T_k_now p)|^2. In the camera's frame of now.
  struct StaticFit {
    Eigen::Vector3d p_cam;
    Eigen::Matrix3d covariance;
    double chi2;  // 3n - 3 degrees of freedom
  };
  /// A point with constant velocity v: p_k = T_k_now (p + v dt_k + a dt_k^2 / 2), a ~ N(0, acceleration^2) as noise.
  /// The window is the longest that such a motion fits: near vehicles that brake or turn leave it within half a second.
  /// Empty with too few observations or when no window fits.
  struct Fits {
    std::optional<StaticFit> at_rest;
    std::optional<SceneFlow> moving;
  };
  Fits fit(const PointTrack& track, const CameraTrail& trail) const;

 private:
  Params params_;
  StereoCamera camera_;
};

std::vector<Parameter> parametersOf(SceneFlowEstimator::Params& params);

}  // namespace motorcade
