#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/geometry/double_lanes.hpp"

namespace motorcade {

/// A point known in some rigid frame `a` (the previous camera, a body) and seen by the stereo camera now.
struct PoseObservation {
  Eigen::Vector3d p_a;
  Eigen::Matrix3d covariance_a;  // of p_a [m^2]
  Eigen::Vector3d uvd_px;
  Eigen::Vector3d sigma_px;  // independent; a huge sigma of d stands for "no disparity"
};

/// The same, laid out to be computed four at a time.
class PoseObservations {
 public:
  explicit PoseObservations(std::span<const PoseObservation> observations);

  /// Four of them. Where there are fewer, the first one fills up.
  struct Block {
    Doubles3 p_a;
    SymmetricDoubles3x3 covariance_a;
    Doubles3 uvd_px, variance_px2;
    Doubles count;  // 1, or 0 for what fills up
  };
  std::span<const Block> blocks() const { return blocks_; }
  std::size_t size() const { return size_; }

 private:
  std::vector<Block> blocks_;
  std::size_t size_;
};

/// Gaussian prior on the pose sought, right perturbation: log(mean^-1 * T) ~ N(0, information^-1).
struct PosePrior {
  SE3 mean;
  Matrix6d information;
};

struct PoseFit {
  SE3 T_cam_a;
  Matrix6d covariance;  // right perturbation of T_cam_a; inverse of the weighted normal matrix
  double inlier_chi2_per_dof = 1;
};

struct PoseFitParams {
  int max_iterations = 10;
  double huber_sigmas = 2.0;   // where the loss turns linear, in units of the whitened residual norm
  double outlier_chi2 = 16.0;  // observations above it get no weight after the first iterations
  double min_step = 1e-6;      // convergence: norm of the increment (m, rad)
};

/// Pose of frame `a` in the camera by robust, covariance-weighted Gauss-Newton:
///   min over T of sum rho(r' S^-1 r), r = uvd - project(T p_a), S = diag(sigma^2) + J C_a J'  (J = d project / d p_a).
/// Weighting by S is what keeps far points, whose depth is poor, from stretching the path.
/// Empty when the problem is singular or diverges.
std::optional<PoseFit> fitPose(const StereoCamera& camera, const PoseObservations& observations,
                               const SE3& initial_T_cam_a, const PoseFitParams& params,
                               const PosePrior* prior = nullptr);

/// Whitened squared residuals of the observations under a pose (3 degrees of freedom); infinite behind the camera.
std::vector<double> poseChi2(const StereoCamera& camera, const PoseObservations& observations, const SE3& T_cam_a);

}  // namespace motorcade
