#pragma once

#include <array>
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

/// Fits the constant X = T_true_cam from the camera of the images to the one whose path the truth gives. The truth of a
/// real drive comes from an inertial unit. Its rotation and lever arm to the camera are calibrated to some hundredths
/// of a radian only. Truth without this error is T_world_true * X.
///
/// The fit is least squares over the drive. It compares the true motions X^-1 (T_i^-1 T_j) X with the estimated ones
/// C_i^-1 C_j, from each frame to the next and from the first frame to each. The latter use positions only, which keep
/// X from following the noise of single frames. A prior on X is needed, as a lever arm shows only where the drive
/// turns. Gauss-Newton linearizes the residual log((X^-1 (T_i^-1 T_j) X)^-1 C_i^-1 C_j) on the right of X, six
/// unknowns.
///
/// Drift that looks like a wrong mounting (a constant turn of the direction of travel) is forgiven, too: read figures
/// with the mounting removed beside those without.
SE3 fitMounting(const std::vector<SE3>& estimate, const std::vector<SE3>& truth);

/// The truth without its mounting error.
std::vector<SE3> withMounting(const std::vector<SE3>& truth, const SE3& T_true_cam);

/// Mean errors of the motion over a path's segments of certain lengths.
struct SegmentMeans {
  std::size_t segments = 0;
  double translation_percent = 0, rotation_deg_per_m = 0;
};

/// Errors of a path as in the KITTI odometry benchmark (Geiger et al., Are we ready for Autonomous Driving? The KITTI
/// Vision Benchmark Suite, 2012, section 3). Segments of eight lengths begin in every tenth frame. Each ends in the
/// first frame that is farther along the true path than its length. The error of its motion is divided by that length.
struct SegmentErrors {
  static constexpr std::size_t kLengths = 8;
  struct OfLength : SegmentMeans {
    double length_m = 0;
  };
  bool short_segments = false;  // of 10 to 80 m instead of 100 to 800 m: the path is shorter than 300 m
  SegmentMeans all;             // over all segments, each counting once
  std::array<OfLength, kLengths> by_length;
};

/// Empty where the path is too short for a single segment. Both paths have one pose per frame, in the same order.
std::optional<SegmentErrors> segmentErrors(const std::vector<SE3>& estimate, const std::vector<SE3>& truth);

}  // namespace motorcade
