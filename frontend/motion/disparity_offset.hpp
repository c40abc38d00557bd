#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/parameters.hpp"
#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/motion/point_track.hpp"

namespace motorcade {

/// Calibrates the rig while it drives. A constant error of the disparities (of the rectification's vergence) bends far
/// depths more than near ones, so no single camera motion explains near and far points alike. Estimates
///   offset = true disparity - measured disparity    [px]
/// next to the motion between two frames, and accumulates it over the drive, starting from a prior around zero.
/// Call in frame order: it remembers what it learned.
class DisparityOffsetEstimator {
 public:
  struct Params {
    double prior_sigma_px = 0.1;  // of a rig that was calibrated well; 0 switches the estimation off
    double max_rate_px = 0.005;   // per frame, by which the offset in use follows the estimate, so that no depth jumps
    int window_frames = 5;        // length of the windows from which the offset is learned
  };
  DisparityOffsetEstimator(const Params& params, const StereoCamera& camera);

  /// First frame of the window that ends with frame `now`; empty when none ends there.
  std::optional<std::int64_t> windowStart(std::int64_t now) const;

  /// Learns from one window: points at rest, their disparities with the offset in use already added. `T_now_then` is
  /// the camera's motion as estimated so far.
  void learn(std::span<const StereoCorrespondence> points, const SE3& T_now_then);

  /// Moves the offset in use towards the estimate; returns by how much it changed.
  double advance();

  /// Offset to add to measured disparities now.
  double offset_px() const { return in_use_px_; }
  double sigma_px() const;

 private:
  struct Measurement {
    double correction_px, variance_px2;
  };
  std::optional<Measurement> measure(std::span<const StereoCorrespondence> points, const SE3& T_now_then) const;

  Params params_;
  StereoCamera camera_;
  double estimate_px_ = 0, variance_px2_ = 0, in_use_px_ = 0;
};

std::vector<Parameter> parametersOf(DisparityOffsetEstimator::Params& params);

}  // namespace motorcade
