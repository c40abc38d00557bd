#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/se3.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// A point in a rigid reference frame `ref` (the previous camera or a body), seen by the stereo camera now.
struct PoseObservation {
  Eigen::Vector3d p_ref;
  Eigen::Matrix3d covariance_ref;  // of p_ref [m^2]
  Eigen::Vector3d uvd_px;
  Eigen::Vector3d sigma_px;  // independent; a huge sigma of d stands for "no disparity"
};

/// Pose observations laid out to be computed four at a time.
class PoseObservations {
 public:
  explicit PoseObservations(std::span<const PoseObservation> observations);

  /// Four observations. Copies of the first one fill a block that has fewer.
  struct Block {
    using Four = std::array<double, 4>;
    std::array<Four, 3> p_ref;
    std::array<Four, 6> covariance_ref;  // upper triangle, row by row
    std::array<Four, 3> uvd_px, variance_px2;
    Four count;  // 1, or 0 for a copy
  };
  std::span<const Block> blocks() const { return blocks_; }
  std::size_t size() const { return size_; }

 private:
  std::vector<Block> blocks_;
  std::size_t size_;
};

/// Gaussian prior on the estimated pose, right perturbation: log(mean^-1 * T) ~ N(0, information^-1).
struct PosePrior {
  SE3 mean;
  Matrix6d information;
};

struct PoseFit {
  SE3 T_cam_ref;
  Matrix6d covariance;  // right perturbation of T_cam_ref; inverse of the weighted normal matrix
  double inlier_chi2_per_dof = 1;
};

struct PoseFitParams {
  int max_iterations = 10;
  double huber_sigmas = 2.0;   // norm of the whitened residual above which the loss is linear
  double outlier_chi2 = 16.0;  // observations above it get no weight after the first iterations
  double min_step = 1e-6;      // convergence: norm of the increment (m, rad)
};

/// Pose of the reference frame in the camera by robust, covariance-weighted Gauss-Newton:
///   min over T of sum rho(r' S^-1 r), r = uvd - project(T p_ref), S = diag(sigma^2) + J C_ref J',
///   J = d project(T p_ref) / d p_ref.
/// The weights S^-1 keep far points, whose depth is poor, from stretching the path.
/// Empty when the problem is singular or diverges.
std::optional<PoseFit> fitPose(const StereoCamera& camera, const PoseObservations& observations,
                               const SE3& initial_T_cam_ref, const PoseFitParams& params,
                               const PosePrior* prior = nullptr);

/// Whitened squared residuals of the observations under a pose (3 degrees of freedom); infinite behind the camera.
std::vector<double> poseChi2(const StereoCamera& camera, const PoseObservations& observations, const SE3& T_cam_ref);

/// Weights and bound of a pose's score. Each observation counts by its weight times its squared residual, at most
/// `max_chi2`.
struct PoseScoring {
  std::span<const double> weights;  // one per observation, none negative
  double max_chi2;
};
/// Sum over the observations, the smaller the better (MSAC); from `bound` on it may be incomplete.
double poseScore(const StereoCamera& camera, const PoseObservations& observations, const SE3& T_cam_ref,
                 const PoseScoring& scoring, double bound);

}  // namespace motorcade
