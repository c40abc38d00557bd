#include "frontend/stereo_pose.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/robust_loss.hpp"

namespace motorcade {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kIterationsWithOutliers = 2;  // Huber alone, before observations beyond the gate are left out

/// Residual of one observation, its Jacobian by the right perturbation of T_cam_a, and the weight S^-1.
struct Linearized {
  Eigen::Vector3d residual_px;
  Eigen::Matrix<double, 3, 6> J;  // d project(T p_a) / d xi
  Eigen::Matrix3d information;
};

std::optional<Linearized> linearize(const StereoCamera& camera, const PoseObservation& o, const SE3& T) {
  const Eigen::Vector3d p_cam = T * o.p_a;
  const auto uvd = camera.project(p_cam);
  if (!uvd) return std::nullopt;
  Linearized l;
  l.residual_px = o.uvd_px - *uvd;
  const Eigen::Matrix3d J_p_a = camera.projectionJacobian(p_cam) * T.rotation();
  Eigen::Matrix3d S = J_p_a * o.covariance_a * J_p_a.transpose();
  S.diagonal() += o.sigma_px.cwiseAbs2();
  l.information = S.inverse();
  l.J.leftCols<3>() = J_p_a;
  l.J.rightCols<3>() = -J_p_a * hat(o.p_a);
  return l;
}

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double inlier_chi2 = 0;
  int inliers = 0;
};

NormalEquations accumulate(const StereoCamera& camera, std::span<const PoseObservation> observations, const SE3& T,
                           const PoseFitParams& params, double gate, const PosePrior* prior) {
  NormalEquations n;
  for (const auto& o : observations) {
    const auto l = linearize(camera, o, T);
    if (!l) continue;
    const double chi2 = l->residual_px.dot(l->information * l->residual_px);
    if (!(chi2 < gate)) continue;
    const double weight = robustWeight(RobustLoss::kHuber, std::sqrt(chi2), params.huber_sigmas);
    const Eigen::Matrix<double, 6, 3> JtW = weight * l->J.transpose() * l->information;
    n.H.noalias() += JtW * l->J;
    n.b.noalias() += JtW * l->residual_px;
    n.inlier_chi2 += weight * chi2;
    ++n.inliers;
  }
  if (prior) {
    const Vector6d e = (prior->mean.inverse() * T).log();
    const Matrix6d Jr = rightJacobianInverseSE3(e);
    n.H.noalias() += Jr.transpose() * prior->information * Jr;
    n.b.noalias() -= Jr.transpose() * prior->information * e;
  }
  return n;
}

}  // namespace

std::optional<PoseFit> fitPose(const StereoCamera& camera, std::span<const PoseObservation> observations, const SE3& initial_T_cam_a,
                               const PoseFitParams& params, const PosePrior* prior) {
  SE3 T = initial_T_cam_a;
  NormalEquations n;
  for (int iteration = 0; iteration < params.max_iterations; ++iteration) {
    const double gate = iteration < kIterationsWithOutliers ? kInfinity : params.outlier_chi2;
    n = accumulate(camera, observations, T, params, gate, prior);
    if (!prior && n.inliers < 3) return std::nullopt;
    const Eigen::LDLT<Matrix6d> solver(n.H);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0)) return std::nullopt;
    const Vector6d step = solver.solve(n.b);
    if (!step.allFinite() || step.norm() > 100) return std::nullopt;
    T = T * SE3::exp(step);
    if (iteration >= kIterationsWithOutliers && step.norm() < params.min_step) break;
  }
  PoseFit fit{.T_cam_a = T.normalized(), .covariance = n.H.inverse(), .chi2 = {}};
  fit.chi2.reserve(observations.size());
  for (const auto& o : observations) fit.chi2.push_back(poseChi2(camera, o, fit.T_cam_a));
  if (n.inliers > 2) fit.inlier_chi2_per_dof = n.inlier_chi2 / (3.0 * n.inliers - 6.0);
  return fit;
}

double poseChi2(const StereoCamera& camera, const PoseObservation& observation, const SE3& T_cam_a) {
  const auto l = linearize(camera, observation, T_cam_a);
  return l ? l->residual_px.dot(l->information * l->residual_px) : kInfinity;
}

}  // namespace motorcade
