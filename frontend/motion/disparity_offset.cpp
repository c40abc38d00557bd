#include "frontend/motion/disparity_offset.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"
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

/// A point's residual; the unknowns of a window are its motion, by a right perturbation of T_now_then, and the offset.
struct Linearized {
  Eigen::Vector3d residual_px;           // observed - predicted
  Eigen::Matrix<double, 3, 6> J_motion;  // of predicted - observed
  Eigen::Vector3d J_offset;
  Eigen::Matrix3d information;
};

/// The normal equations of a window.
struct NormalEquations {
  void add(const Linearized& l, double weight) {
    const Eigen::Matrix<double, 6, 3> JtW = weight * l.J_motion.transpose() * l.information;
    const Eigen::Vector3d W_J_offset = weight * l.information * l.J_offset;
    H_motion.noalias() += JtW * l.J_motion;
    H_mixed.noalias() += JtW * l.J_offset;
    H_offset += W_J_offset.dot(l.J_offset);
    b_motion.noalias() += JtW * l.residual_px;
    b_offset += W_J_offset.dot(l.residual_px);
  }

  struct Step {
    Vector6d motion;
    double offset_px, offset_variance_px2;
  };
  /// Eliminates the motion: the Schur complement is the information about the offset alone.
  std::optional<Step> solve() const {
    const Eigen::LLT<Matrix6d> llt(H_motion);
    if (llt.info() != Eigen::Success) return std::nullopt;
    const Vector6d motion_per_offset = llt.solve(H_mixed);
    const double information = H_offset - H_mixed.dot(motion_per_offset);
    if (!(information > 0)) return std::nullopt;
    const double offset_px = (b_offset - motion_per_offset.dot(b_motion)) / information;
    return Step{llt.solve(b_motion) - motion_per_offset * offset_px, offset_px, 1 / information};
  }

  Matrix6d H_motion = Matrix6d::Zero();
  Vector6d H_mixed = Vector6d::Zero(), b_motion = Vector6d::Zero();
  double H_offset = 0, b_offset = 0;
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
  l.J_motion << J_p_then, -J_p_then * hat(p_then);
  l.J_offset = J_uvd_then.col(2) - Eigen::Vector3d::UnitZ();
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
  Measurement measurement{.correction_px = 0, .variance_px2 = 0};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    NormalEquations equations;
    int inliers = 0;
    for (const auto& c : points) {
      const auto l = linearize(camera_, c, T, measurement.correction_px);
      if (!l) continue;
      const double chi2 = l->residual_px.dot(l->information * l->residual_px);
      if (iteration > 0 && chi2 > kInlierChi2) continue;
      equations.add(*l, robustWeight(RobustLoss::kHuber, std::sqrt(chi2), kHuberSigmas));
      ++inliers;
    }
    if (inliers < kMinPoints) return std::nullopt;
    const auto step = equations.solve();
    if (!step || !(hypotenuse(step->motion.norm(), step->offset_px) < kMaxStep)) return std::nullopt;
    T = T * SE3::exp(step->motion);
    measurement.correction_px += step->offset_px;
    measurement.variance_px2 = step->offset_variance_px2;
  }
  return measurement;
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
