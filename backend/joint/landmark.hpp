#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/robust_loss.hpp"
#include "core/se3.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// The pose variable of a frame: the camera's in the world, in which the landmarks rest, or the body's seen from the
/// camera. Observations change by its steps in the world's axes (see `displaced`).
enum class FramePose { kWorldCam, kCamBody };

/// An observation of a landmark; `frame` counts the frames of the factor that holds it.
struct LandmarkView {
  int frame = 0;
  Eigen::Vector3d uvd_px;
  Eigen::Vector3d inverse_sigma;  // of u, v, d [1/px]
};

/// Noise model of landmark observations.
struct LandmarkNoise {
  RobustLoss loss = RobustLoss::kCauchy;
  double loss_scale = 1.5;  // of an observation's whitened norm: three dimensions
  /// Degrees of freedom of the prior of a landmark's own variance, a scaled inverse chi-squared distribution: some
  /// landmarks are followed well, others slide along edges. The residuals of a landmark then follow a multivariate t
  /// distribution (Lange, Little and Taylor, JASA 1989). With 0, all are alike.
  double variance_freedom = 4;
  /// Error that all disparities of a landmark share: a part that does not depend on the landmark, and a share of the
  /// noise of one of its disparities.
  double shared_disparity_sigma_px = 0.1, shared_disparity_share = 0;
  /// Standard deviation of an error that all disparities of a frame share. With 0, the cameras do not shake.
  double shake_sigma_px = 0;

  /// Mean square of a Gaussian residual under the weights of the loss, per dimension: E[w r^2] / 3.
  double meanSquare() const;
};

/// Unknowns of a landmark at its last view: (u, v, d) there and the error that its disparities share.
using Vector4d = Eigen::Vector4d;
using Matrix4d = Eigen::Matrix4d;

/// Place of a landmark from an earlier fit, from which the next fit begins.
struct LandmarkEstimate {
  Eigen::Vector3d p_body;
  double shared_error_px = 0;
};

/// A landmark as its views tell it, in the camera of the newest: its unknowns, and their covariance given the poses.
struct KnownLandmark {
  Vector4d unknowns;
  Matrix4d covariance;
};

/// Linear model of an observation, whitened and weighted. Rows are contiguous for the sums of products J' J, J' B.
struct LinearView {
  /// [A D r] with the Jacobians by a step of the frame's pose and by the disparity offset, and the residual.
  Eigen::Matrix<double, 3, 8, Eigen::RowMajor> J;
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> B;  // by the landmark
  auto r() const { return J.col(7); }
};

/// Fits landmarks to their views from known poses (variable projection: poses move, landmarks follow).
class LandmarkFit {
 public:
  /// Fits in frames with these `T_cam_body`, for a landmark at rest in the body. The offset is added to all
  /// disparities.
  LandmarkFit(const StereoCamera& camera, const LandmarkNoise& noise, FramePose pose, std::span<const SE3> T_cam_body,
              double offset_px);

  /// Fits a landmark, from an estimate if there is one, else from the newest view. Returns false when a view would lie
  /// behind its camera or the landmark is at infinity.
  bool operator()(std::span<const LandmarkView> views, const std::optional<LandmarkEstimate>& before = std::nullopt);

  /// Linear models of the views, also weighted by the landmark's own variance.
  std::span<const LinearView> views() const { return std::span(linear_).first(count_); }
  /// The landmark's own variance, in units of the one that its views claim.
  double variance() const { return variance_; }
  /// Share of the information of `views` that is left because the variance is unknown: (n + d) / (n + d + 2) with n
  /// degrees of freedom of the prior and d of the residuals, the Fisher information of the t distribution.
  double informationShare() const { return information_share_; }
  const Eigen::LLT<Matrix4d>& information() const { return llt_; }
  /// Estimate after one more step from where the landmark was linearized; empty when that is at infinity.
  std::optional<LandmarkEstimate> estimate() const;
  /// The same with its covariance.
  std::optional<KnownLandmark> known() const;
  double sharedError_px() const { return landmark_[3]; }
  double sharedErrorSigma_px() const { return shared_sigma_px_; }

  /// State at which views are linearized, and the sums over them.
  struct Linearization {
    const StereoCamera& camera;
    const LandmarkNoise& noise;
    FramePose pose;
    std::span<const double> poses;  // T_cam_body of all frames, one after the other: rotation by columns, translation
    double offset_px, variance;
    Eigen::Vector3d p_body;
    Eigen::Matrix3d G;  // d(p_body) / d(u, v, d of the newest view)
    Matrix4d V = Matrix4d::Zero();
    Vector4d gradient = Vector4d::Zero();
    double squares = 0;  // weighted residuals
  };

 private:
  bool beginFrom(const LandmarkEstimate& before);
  bool linearize(std::span<const LandmarkView> views);
  void weighByOwnVariance();
  void addSharedError(std::span<const LandmarkView> views);

  const StereoCamera& camera_;
  LandmarkNoise noise_;
  FramePose pose_;
  std::span<const SE3> T_cam_body_;
  double offset_px_;
  std::vector<double> poses_;
  int newest_frame_ = 0;
  Vector4d landmark_, gradient_;
  Matrix4d V_;
  Eigen::LLT<Matrix4d> llt_;  // of V
  double squares_ = 0;        // of the views' weighted residuals, before the own variance counts
  double variance_ = 1, information_share_ = 1, shared_sigma_px_ = 0;
  std::size_t count_ = 0;           // of views
  std::vector<LinearView> linear_;  // theirs, and what fills up the last four
};

}  // namespace motorcade
