#include "backend/joint/known_landmarks.hpp"

#include <optional>

#include <Eigen/Cholesky>

namespace motorcade {
namespace {

/// Columns of the system: displacements of both poses, the offset, and the right-hand side.
constexpr int kColumns = 14;

/// A view's residual and how it changes with the motion, whitened by the noise of view and landmark.
struct Alignment {
  Eigen::Matrix<double, 3, 6> J;
  Eigen::Vector3d r;
};

/// Only the earlier pose is displaced, as motions count relative to the last: p_last = T_last_first exp(-e) p_first.
std::optional<Alignment> align(const StereoCamera& camera, const ViewOfKnown& view, const SE3& T_last_first,
                               double offset_px) {
  const Eigen::Vector3d uvd_px = view.landmark.unknowns.head<3>();
  if (!(uvd_px.z() > 0)) return std::nullopt;
  const Eigen::Vector3d p_first = camera.triangulate(uvd_px), p_last = T_last_first * p_first;
  const auto predicted = camera.project(p_last);
  if (!predicted) return std::nullopt;
  Alignment a;
  a.r = view.uvd_px - *predicted;
  a.r.z() += offset_px - view.landmark.unknowns[3];
  a.r.array() *= view.inverse_sigma.array();
  const Eigen::Matrix3d by_point =
      -(view.inverse_sigma.asDiagonal() * (camera.projectionJacobian(p_last) * T_last_first.rotation()));
  Eigen::Matrix<double, 3, 4> B;
  B.leftCols<3>().noalias() = by_point * camera.triangulationJacobian(uvd_px);
  B.col(3) << 0, 0, -view.inverse_sigma.z();
  a.J.leftCols<3>() = -by_point;
  a.J.rightCols<3>().noalias() = by_point * hat(p_first);
  const Eigen::Matrix3d S = Eigen::Matrix3d::Identity() + B * (view.landmark.covariance * B.transpose());
  const Eigen::LLT<Eigen::Matrix3d> llt(S);
  llt.matrixL().solveInPlace(a.J);
  llt.matrixL().solveInPlace(a.r);
  return a;
}

}  // namespace

EliminatedLandmarks alignToKnown(const StereoCamera& camera, const LandmarkNoise& noise,
                                 std::span<const ViewOfKnown> views, const std::array<SE3, 2>& T_cam_body,
                                 double offset_px) {
  const SE3 T_last_first = T_cam_body[1] * T_cam_body[0].inverse();
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double c = 0;
  for (const ViewOfKnown& view : views) {
    const auto a = align(camera, view, T_last_first, offset_px);
    if (!a) continue;
    const double weight = robustWeight(noise.loss, a->r.norm(), noise.loss_scale);
    H.noalias() += weight * (a->J.transpose() * a->J);
    g.noalias() += weight * (a->J.transpose() * a->r);
    c += weight * a->r.squaredNorm();
  }
  EliminatedLandmarks result{.T_cam_body = {T_cam_body[0], T_cam_body[1]},
                             .offset_px = offset_px,
                             .system = Eigen::MatrixXd::Zero(kColumns, kColumns),
                             .levels = {},
                             .estimates = {}};
  result.system.topLeftCorner<6, 6>() = H;
  result.system.topRightCorner<6, 1>() = g;
  result.system.bottomLeftCorner<1, 6>() = g.transpose();
  result.system(kColumns - 1, kColumns - 1) = c;
  return result;
}

}  // namespace motorcade
