#include "backend/motion/point_set_fit.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/decompositions.hpp"
#include "core/robust_loss.hpp"

namespace motorcade {
namespace {

constexpr int kMostIterations = 15;
constexpr int kPlainIterations = 2;     // far from the solution all points are off, and no weight could tell which
constexpr double kLossScale = 1.5;      // of a whitened residual's norm (three dimensions)
constexpr double kLeastStep = 1e-7;     // m, rad: far below what is measured
constexpr double kGreatestStep = 50.0;  // beyond which the fit diverges

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();         // J' W J and the prior
  Vector6d gradient = Vector6d::Zero();  // of half the cost

  /// Adds a point; false when it lies behind the camera.
  bool add(const StereoCamera& camera, const SeenPoint& point, const SE3& T_cam_ref, RobustLoss loss) {
    const auto predicted = camera.project(T_cam_ref * point.p_ref);
    if (!predicted) return false;
    const Eigen::Matrix3d J_p = camera.projectionJacobian(T_cam_ref * point.p_ref) * T_cam_ref.rotation();
    Eigen::Matrix3d S = J_p * point.covariance_ref * J_p.transpose();
    S.diagonal() += point.sigma_px.cwiseAbs2();
    const Eigen::Matrix3d information = S.inverse();
    const Eigen::Vector3d r = point.uvd_px - *predicted;
    const double weight = robustWeight(loss, std::sqrt(r.dot(information * r)), kLossScale);
    Eigen::Matrix<double, 3, 6> J;
    J << -J_p, J_p * hat(point.p_ref);
    const Eigen::Matrix<double, 3, 6> WJ = weight * information * J;
    H.noalias() += J.transpose() * WJ;
    gradient.noalias() += WJ.transpose() * r;
    return true;
  }
  void add(const ExpectedPose& expected, const SE3& T_cam_ref) {
    const Vector6d e = (expected.T_cam_ref.inverse() * T_cam_ref).log();
    const Matrix6d J = rightJacobianInverseSE3(e);
    const Matrix6d WJ = expected.sigma.cwiseAbs2().cwiseInverse().asDiagonal() * J;
    H.noalias() += J.transpose() * WJ;
    gradient.noalias() += WJ.transpose() * e;
  }
};

}  // namespace

std::optional<PointSetFit> fitPointSet(const StereoCamera& camera, std::span<const SeenPoint> points,
                                       const ExpectedPose& expected) {
  SE3 T = expected.T_cam_ref;
  for (int iteration = 0;; ++iteration) {
    const RobustLoss loss = iteration < kPlainIterations ? RobustLoss::kNone : RobustLoss::kCauchy;
    NormalEquations equations;
    equations.add(expected, T);
    for (const SeenPoint& point : points)
      if (!equations.add(camera, point, T, loss)) return std::nullopt;
    const Eigen::LLT<Matrix6d> cholesky(equations.H);
    if (cholesky.info() != Eigen::Success) return std::nullopt;
    const Vector6d step = -cholesky.solve(equations.gradient);
    if (!(step.norm() < kGreatestStep)) return std::nullopt;
    const bool settled = iteration > kPlainIterations && step.norm() < kLeastStep;
    if (settled || iteration == kMostIterations) {
      const Matrix6d covariance = inverse(cholesky);
      return PointSetFit{T.normalized(), 0.5 * (covariance + covariance.transpose())};
    }
    T = T * SE3::exp(step);
  }
}

}  // namespace motorcade
