#pragma once

#include <optional>

#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Compares the brightness of cells with that of the frame before, where the body's motion and rest take them from.
class MotionEvidence {
 public:
  /// `view.before` is known. All three outlive the evidence.
  MotionEvidence(const LevelDisparities& disparities, const ObjectView& view, const StereoCamera& camera)
      : disparities_(disparities),
        view_(view),
        camera_(camera),
        T_before_moved_(view.before->T_before_body * view.T_cam_body.inverse()) {}

  /// By how much better a cell rested than moved with the body [gray levels]; zero where the two can hardly be told
  /// apart. Its disparity is known.
  float operator()(int column, int row) const;

 private:
  std::optional<float> difference(int column, int row, const Eigen::Vector3d& before_uvd_px) const;

  const LevelDisparities& disparities_;
  const ObjectView& view_;
  const StereoCamera& camera_;
  SE3 T_before_moved_;
};

}  // namespace motorcade
