#include "frontend/motion/disparity_offset.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/robust_loss.hpp"

namespace motorcade {
namespace {

constexpr double kMinMotion_m = 2.0;  // of the camera in a window: depths hardly show in a shorter one
constexpr int kMinPoints = 60;        // of a window: fewer rarely hold near and far ones alike
constexpr double kInlierChi2 = 9.0;   // 3 degrees of freedom: 97 %
constexpr double kHuberSigmas = 2.0;  // where the loss turns linear
constexpr double kInflation = 3.0;    // of a window's variance: neighboring windows share points and their errors
constexpr int kIterations = 4;        // Gauss-Newton from the motion as estimated: converged to 1e-4 px
constexpr double kMaxStep = 10;       // (m, rad, px): a longer one diverges

constexpr double kFarOff_px = 0.5;    // a rig that is off so far hides more of the scene than moving depths do,
constexpr double kFastRate_px = 0.1;  // and is followed fast

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// Unknowns of one window: (motion by right perturbation of T_now_then, offset).
struct Linearized {
  Eigen::Vector3d residual_px;    // observed - predicted
  Eigen::Matrix<double, 3, 7> J;  // of predicted - observed
  Eigen::Matrix3d information;
};

std::optional<Linearized> linearize(const StereoCamera& camera, const StereoCorrespondence& c, const SE3& T_now_then,
                                    double offset_px) {
  const Eigen::Vector3d offset(0, 0, offset_px), uvd_then = c.uvd_then_px + offset;
  if (uvd_then.z() <= 0) return std::nullopt;
  const Eigen::Vector3d p_then = camera.triangulate(uvd_then), p_now = T_now_then * p_then;
  const auto predicted = camera.project(p_now);
  if (!predicted) return std::nullopt;
  const Eigen::Matrix3d J_p_then = camera.projectionJacobian(p_now) * T_now_then.rotation();
  const Eigen::Matrix3d J_uvd_then = J_p_then * camera.triangulationJacobian(uvd_then);
  Linearized l;
  l.residual_px = c.uvd_now_px + offset - *predicted;
  l.J << J_p_then, -J_p_then * hat(p_then), J_uvd_then.col(2) - Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d S = J_uvd_then * c.sigma_then_px.cwiseAbs2().asDiagonal() * J_uvd_then.transpose();
  S.diagonal() += c.sigma_now_px.cwiseAbs2();
  l.information = S.inverse();
  return l;
}

}  // namespace

DisparityOffsetEstimator::DisparityOffsetEstimator(const Params& params, const StereoCamera& camera)
    : params_(requireValid(params)), camera_(camera), variance_px2_(params.prior_sigma_px * params.prior_sigma_px) {}

double DisparityOffsetEstimator::sigma_px() const { return std::sqrt(variance_px2_); }

std::optional<DisparityOffsetEstimator::Measurement> DisparityOffsetEstimator::measure(
    std::span<const StereoCorrespondence> points, const SE3& T_now_then) const {
  SE3 T = T_now_then;
  double offset_px = 0;
  Matrix7d H;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    H.setZero();
    Vector7d b = Vector7d::Zero();
    int inliers = 0;
    for (const auto& c : points) {
      const auto l = linearize(camera_, c, T, offset_px);
      if (!l) continue;
      const double chi2 = l->residual_px.dot(l->information * l->residual_px);
      if (iteration > 0 && chi2 > kInlierChi2) continue;
      const Eigen::Matrix<double, 7, 3> JtW =
          robustWeight(RobustLoss::kHuber, std::sqrt(chi2), kHuberSigmas) * l->J.transpose() * l->information;
      H.noalias() += JtW * l->J;
      b.noalias() += JtW * l->residual_px;
      ++inliers;
    }
    if (inliers < kMinPoints) return std::nullopt;
    const Vector7d step = H.ldlt().solve(b);
    if (!step.allFinite() || step.norm() > kMaxStep) return std::nullopt;
    T = T * SE3::exp(step.head<6>());
    offset_px += step[6];
  }
  return Measurement{offset_px, H.inverse()(6, 6)};
}

std::optional<std::int64_t> DisparityOffsetEstimator::windowStart(std::int64_t now) const {
  if (now % params_.window_frames != 0) return std::nullopt;
  return now - params_.window_frames;
}

void DisparityOffsetEstimator::learn(std::span<const StereoCorrespondence> points, const SE3& T_now_then) {
  if (params_.prior_sigma_px <= 0 || T_now_then.translation().norm() < kMinMotion_m) return;
  const auto measured = measure(points, T_now_then);
  if (!measured) return;
  const double variance = kInflation * measured->variance_px2;
  const double gain = variance_px2_ / (variance_px2_ + variance);
  estimate_px_ += gain * (in_use_px_ + measured->correction_px - estimate_px_);
  variance_px2_ *= 1 - gain;
}

double DisparityOffsetEstimator::advance() {
  const double gap_px = estimate_px_ - in_use_px_;
  const double rate_px = std::abs(gap_px) > kFarOff_px ? kFastRate_px : params_.max_rate_px;
  const double change = std::clamp(gap_px, -rate_px, rate_px);
  in_use_px_ += change;
  return change;
}

std::vector<Parameter> parametersOf(DisparityOffsetEstimator::Params& params) {
  return {numberParameter("prior_sigma_px", params.prior_sigma_px, {0, 5},
                          "how far the calibration of the rig may be off; 0 trusts it")};
}

}  // namespace motorcade
