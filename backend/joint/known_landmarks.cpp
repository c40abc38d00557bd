#include "backend/joint/known_landmarks.hpp"

#include <optional>

#include <Eigen/Cholesky>

#include "core/fixed_product.hpp"

namespace motorcade {
namespace {

/// Columns of the system: displacements of both poses, the offset, and the right-hand side.
constexpr int kSystemColumns = 14;

/// A view's residual and how it changes with the motion, whitened by the noise of view and landmark.
struct Alignment {
  Eigen::Matrix<double, 3, 6> J;
  Eigen::Vector3d r;
};

/// By a step of the earlier pose in the world.
std::optional<Alignment> align(const StereoCamera& camera, const ViewOfKnown& view,
                               const std::array<SE3, 2>& T_cam_world, double offset_px) {
  const SE3 T_last_first = T_cam_world[1] * T_cam_world[0].inverse();
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
  a.J.leftCols<3>().noalias() = by_point * T_cam_world[0].rotation();
  a.J.rightCols<3>().noalias() = -a.J.leftCols<3>() * hat(T_cam_world[0].rotation().transpose() * p_first);
  const Eigen::Matrix3d S = Eigen::Matrix3d::Identity() + B * (view.landmark.covariance * B.transpose());
  const Eigen::LLT<Eigen::Matrix3d> llt(S);
  llt.matrixL().solveInPlace(a.J);
  llt.matrixL().solveInPlace(a.r);
  return a;
}

}  // namespace

EliminatedLandmarks alignToKnown(const StereoCamera& camera, const LandmarkNoise& noise,
                                 std::span<const ViewOfKnown> views, const std::array<SE3, 2>& T_cam_world,
                                 double offset_px) {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double c = 0;
  for (const ViewOfKnown& view : views) {
    const auto a = align(camera, view, T_cam_world, offset_px);
    if (!a) continue;
    const double weight = robustWeight(noise.loss, a->r.norm(), noise.loss_scale);
    H.noalias() += weight * (a->J.transpose() * a->J);
    g.noalias() += weight * (a->J.transpose() * a->r);
    c += weight * a->r.squaredNorm();
  }
  EliminatedLandmarks result{.pose = FramePose::kWorldCam,
                             .T_cam_body = {T_cam_world[0], T_cam_world[1]},
                             .offset_px = offset_px,
                             .system = {},
                             .levels = {},
                             .estimates = {}};
  // What a step of the later pose does, one of the earlier undoes.
  Eigen::Matrix<double, 6, 12> by_both;
  by_both << Matrix6d::Identity(), -Matrix6d::Identity();
  by_both.topRightCorner<3, 3>() = hat(T_cam_world[0].inverse().translation() - T_cam_world[1].inverse().translation());
  Eigen::Matrix<double, kSystemColumns, kSystemColumns> system =
      Eigen::Matrix<double, kSystemColumns, kSystemColumns>::Zero();
  const Eigen::Matrix<double, 12, 6> by_both_T = by_both.transpose();
  system.topLeftCorner<12, 12>() = propagated(by_both_T, H);
  system.bottomLeftCorner<1, 12>() = g.transpose() * by_both;
  system(kSystemColumns - 1, kSystemColumns - 1) = c;
  pack(system, result.system);
  return result;
}

}  // namespace motorcade
