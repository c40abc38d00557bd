#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/motion/coarse_localization.hpp"
#include "frontend/motion/ego_motion.hpp"

namespace motorcade {

/// Finds points at rest again in a stereo pair after others were missing, dark, blurred or damaged, and tells how the
/// camera moved meanwhile. It searches by projection, by the patches around the points. Stateless.
class GapBridge {
 public:
  /// Longest gap that is bridged: beyond it little of what was seen is still in view, and places begin to look alike.
  static constexpr double kMaxGap_s = 2.5;

  GapBridge(const EgoMotionEstimator::Params& params, const StereoCamera& camera)
      : ego_motion_(params, camera), camera_(camera) {}

  struct Gap {
    std::span<const RestingPoint> points;
    const Features& then;
    const Features& now;
    double disparity_offset_px = 0;
    double duration_s = 0;
    int ahead_frames = 0;  // see PredictedMotion, as is the next
    Eigen::Matrix3d R_cam_level = Eigen::Matrix3d::Identity();
  };
  /// T_then_now by a search around the predicted motion; empty when the points do not agree on one.
  std::optional<SE3> locate(const Gap& gap, const SE3& predicted_T_then_now) const;

  /// Finds the points in the left image of now, where a known motion puts them to a few pixels. Returns one observation
  /// per point that is found, in the order of the points.
  std::vector<FlowObservation> find(const Gap& gap, const SE3& T_then_now) const;

 private:
  std::vector<FlowObservation> search(const Gap& gap, const SE3& T_then_now, int first_level) const;
  std::optional<SE3> fit(const Gap& gap, const std::vector<FlowObservation>& found, const SE3& T_then_now) const;

  EgoMotionEstimator ego_motion_;
  StereoCamera camera_;
};

}  // namespace motorcade
