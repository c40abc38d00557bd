#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/se3.hpp"

/// Errors of an estimated trajectory. Estimate and truth have one pose per frame, in the same order.
namespace motorcade {

inline constexpr double kSigmas95 = 1.96;  // half the width of the 95 % interval of a Gaussian

struct Statistics {
  double rmse = 0, mean = 0, median = 0, p95 = 0, max = 0;
  std::size_t count = 0;
};
/// Statistics of the magnitudes of errors; between two errors the 95th percentile is interpolated.
Statistics statisticsOf(std::vector<double> errors);

/// The rigid motion S that brings S * estimate closest to truth: least squares over the positions
/// (Umeyama, Least-squares estimation of transformation parameters between two point patterns, 1991, without scale).
SE3 alignPositions(const std::vector<SE3>& estimate, const std::vector<SE3>& truth);

/// Errors of a trajectory (Sturm et al., A benchmark for the evaluation of RGB-D SLAM systems, 2012).
struct TrajectoryErrors {
  Statistics ate_m;             // absolute, after SE(3) alignment
  Statistics ate_first_pose_m;  // absolute, aligned at the first pose
  /// Absolute rotation, aligned by the mean rotation: positions on a straight road do not determine the roll.
  Statistics are_deg;
  Statistics rpe_m, rpe_deg;  // relative, from each pose to the next
  double end_percent = 0;     // of the path's length, aligned at the first pose
  double length_m = 0;        // of the true path
};
/// Empty for fewer than two poses.
std::optional<TrajectoryErrors> trajectoryErrors(const std::vector<SE3>& estimate, const std::vector<SE3>& truth);

/// Difference of the estimated step from one pose to the next to the true step.
SE3 stepError(const SE3& estimate_before, const SE3& estimate, const SE3& truth_before, const SE3& truth);

double angleOf_deg(const Eigen::Matrix3d& rotation);

}  // namespace motorcade
