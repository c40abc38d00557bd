#pragma once

#include <span>

#include "backend/joint/landmark_elimination.hpp"

namespace motorcade {

/// Sums of squared whitened residuals, and counts of those that the landmarks' own unknowns leave; both are equal where
/// the noise is as claimed.
struct ResidualLevels {
  double uv_sum = 0, uv_count = 0, d_sum = 0, d_count = 0;
  double successive_sum = 0;  // of the products of residuals of a landmark's successive views
  /// Products of residuals of different landmarks in the same cell of the image, in any frames. They show errors of the
  /// rectification, which stay where they are.
  double neighbor_sum = 0, neighbor_count = 0;
  double views = 0;
};

/// Levels of landmarks that are fitted to their views. The views contain no shake any more.
ResidualLevels residualLevels(const StereoCamera& camera, const LandmarkNoise& noise, const LandmarkViews& landmarks,
                              FramePose pose, std::span<const SE3> T_cam_body, double offset_px);

/// Mean number of views of other landmarks in the cell of a view. There is at least one view.
double neighborsPerView(const StereoCamera& camera, const LandmarkViews& landmarks);

}  // namespace motorcade
