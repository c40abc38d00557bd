#include "backend/joint/known_landmarks.hpp"

#include <optional>
#include <vector>

#include <Eigen/Cholesky>

#include "core/fixed_product.hpp"

namespace motorcade {
namespace {

/// Columns of the system: displacements of both poses, the offset, and the right-hand side.
constexpr int kSystemColumns = 14;

/// A view's residual and how it changes with the motion and with the shake, whitened by the noise of view and landmark.
struct Alignment {
  Eigen::Matrix<double, 3, 6> J;
  Eigen::Vector3d by_shake, r;
};

/// The normal equations of views, in (motion, shake), around a shake that is known.
struct AlignmentSum {
  double known_px;
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero(), by_shake = Vector6d::Zero();
  double shake_information = 0, shake_gradient = 0, c = 0;

  void add(const Alignment& a, const LandmarkNoise& noise) {
    const Eigen::Vector3d r = a.r + known_px * a.by_shake;
    const double weight = robustWeight(noise.loss, r.norm(), noise.loss_scale);
    H.noalias() += weight * (a.J.transpose() * a.J);
    g.noalias() += weight * (a.J.transpose() * r);
    by_shake.noalias() += weight * (a.J.transpose() * a.by_shake);
    shake_information += weight * a.by_shake.squaredNorm();
    shake_gradient += weight * a.by_shake.dot(r);
    c += weight * r.squaredNorm();
  }

  FrameShake eliminateShake(double sigma_px) {
    const double prior = 1 / (sigma_px * sigma_px), variance_px2 = 1 / (shake_information + prior);
    const double gradient = shake_gradient + prior * known_px, step_px = -variance_px2 * gradient;
    H.noalias() -= variance_px2 * (by_shake * by_shake.transpose());
    g += step_px * by_shake;
    c += prior * known_px * known_px + step_px * gradient;
    return {known_px + step_px, variance_px2};
  }
};

/// Shake with the pose as it is taken to be, for robust weights to follow it.
double shakeOfPose(const std::vector<Alignment>& aligned, const LandmarkNoise& noise) {
  double information = 1 / (noise.shake_sigma_px * noise.shake_sigma_px), gradient = 0;
  for (const Alignment& a : aligned) {
    const double weight = robustWeight(noise.loss, a.r.norm(), noise.loss_scale);
    information += weight * a.by_shake.squaredNorm();
    gradient += weight * a.by_shake.dot(a.r);
  }
  return -gradient / information;
}

/// Aligns a view; its Jacobian is by a step of the earlier pose in the world.
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
  a.by_shake = Eigen::Vector3d(0, 0, view.inverse_sigma.z());
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
  llt.matrixL().solveInPlace(a.by_shake);
  llt.matrixL().solveInPlace(a.r);
  return a;
}

}  // namespace

EliminatedLandmarks alignToKnown(const StereoCamera& camera, const LandmarkNoise& noise,
                                 std::span<const ViewOfKnown> views, const std::array<SE3, 2>& T_cam_world,
                                 double offset_px) {
  std::vector<Alignment> aligned;
  for (const ViewOfKnown& view : views)
    if (const auto a = align(camera, view, T_cam_world, offset_px)) aligned.push_back(*a);
  const bool shaken = noise.shake_sigma_px > 0;
  AlignmentSum sum{.known_px = shaken ? shakeOfPose(aligned, noise) : 0};
  for (const Alignment& a : aligned) sum.add(a, noise);
  FrameShake shake;
  if (shaken) shake = sum.eliminateShake(noise.shake_sigma_px);
  EliminatedLandmarks result{.pose = FramePose::kWorldCam,
                             .T_cam_body = {T_cam_world[0], T_cam_world[1]},
                             .offset_px = offset_px,
                             .system = {},
                             .shakes = {},
                             .estimates = {}};
  if (shaken) result.shakes = {FrameShake{}, shake};
  // A step of the later pose is undone by one of the earlier pose.
  Eigen::Matrix<double, 6, 12> by_both;
  by_both << Matrix6d::Identity(), -Matrix6d::Identity();
  by_both.topRightCorner<3, 3>() = hat(T_cam_world[0].inverse().translation() - T_cam_world[1].inverse().translation());
  Eigen::Matrix<double, kSystemColumns, kSystemColumns> system =
      Eigen::Matrix<double, kSystemColumns, kSystemColumns>::Zero();
  const Eigen::Matrix<double, 12, 6> by_both_T = by_both.transpose();
  system.topLeftCorner<12, 12>() = propagated(by_both_T, sum.H);
  system.bottomLeftCorner<1, 12>() = sum.g.transpose() * by_both;
  system(kSystemColumns - 1, kSystemColumns - 1) = sum.c;
  pack(system, result.system);
  return result;
}

}  // namespace motorcade
