#pragma once

#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"

/// Agreement of boxes and cuboids with the labels', over the reported rows that were matched to labels which are asked
/// for.
namespace motorcade {

/// Errors of the matched rows in one range of distances.
struct BoxErrors {
  int rows = 0, rows_with_cuboid = 0;
  double iou_2d = 0, over_half_2d = 0;  // mean, and share above 1/2, in the left image
  double iou_bird = 0, iou_3d = 0;      // means, as seen from the camera
  /// |estimated - labeled|: middle of the footprint, heading (up to half a turn), length, width, height.
  Statistics center_m, heading_deg, length_m, width_m, height_m;
  /// Shares of the cuboids whose length, width and height differ from the label's by at most two of their standard
  /// deviations: .954 of normally distributed errors.
  Eigen::Array3d size_within_2_sigma = Eigen::Array3d::Zero();
};

BoxErrors boxErrors(const std::vector<ComparedFrame>& frames, double from_m, double to_m);

}  // namespace motorcade
