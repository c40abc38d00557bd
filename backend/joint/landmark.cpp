#include "backend/joint/landmark.hpp"

#include <cmath>

#include "backend/joint/row_products.hpp"

namespace motorcade {
namespace {

constexpr double kLeastDisparity_px = 0.3;  // a landmark with less is at infinity
constexpr double kLeastSharedSigma_px = 1e-3;

}  // namespace

/// Two steps from the newest view, or one from an estimate: what is left, the elimination takes into account.
bool LandmarkFit::operator()(std::span<const LandmarkView> views, const std::optional<LandmarkEstimate>& before) {
  newest_frame_ = views.back().frame;
  if (!before || !beginFrom(*before)) {
    landmark_ << views.back().uvd_px + Eigen::Vector3d(0, 0, offset_px_), 0;
    if (!linearize(views, false)) return false;
    landmark_ -= llt_.solve(gradient_);
  }
  return linearize(views, true);
}

bool LandmarkFit::beginFrom(const LandmarkEstimate& before) {
  const auto uvd_px = camera_.project(T_cam_body_[newest_frame_] * before.p_body);
  if (!uvd_px) return false;
  landmark_ << *uvd_px, before.shared_error_px;
  return true;
}

std::optional<LandmarkEstimate> LandmarkFit::estimate() const {
  const Vector4d landmark = landmark_ - llt_.solve(gradient_);
  if (!(landmark[2] > kLeastDisparity_px)) return std::nullopt;
  return LandmarkEstimate{T_cam_body_[newest_frame_].inverse() * camera_.triangulate(landmark.head<3>()), landmark[3]};
}

bool LandmarkFit::linearize(std::span<const LandmarkView> views, bool with_poses) {
  if (!(landmark_[2] > kLeastDisparity_px)) return false;
  const SE3 T_body_cam = T_cam_body_[newest_frame_].inverse();
  const Eigen::Vector3d uvd_px = landmark_.head<3>(), p_body = T_body_cam * camera_.triangulate(uvd_px);
  const Eigen::Matrix3d G = T_body_cam.rotation() * camera_.triangulationJacobian(uvd_px);
  linear_.clear();
  V_.setZero();
  gradient_.setZero();
  for (const LandmarkView& view : views)
    if (!linearizeView(view, p_body, G, with_poses)) return false;
  const double shared = 1 / std::max(noise_.shared_disparity_sigma_px, kLeastSharedSigma_px);
  V_(3, 3) += shared * shared;
  gradient_[3] += shared * shared * landmark_[3];
  llt_.compute(V_);
  return true;
}

/// `G` = d(p_body) / d(u, v, d of the newest view).
bool LandmarkFit::linearizeView(const LandmarkView& view, const Eigen::Vector3d& p_body, const Eigen::Matrix3d& G,
                                bool with_poses) {
  const SE3& T = T_cam_body_[view.frame];
  const Eigen::Vector3d p_cam = T * p_body;
  const auto predicted = camera_.project(p_cam);
  if (!predicted) return false;
  Eigen::Vector3d r = view.uvd_px - *predicted;
  r.z() += offset_px_ - landmark_[3];
  r.array() *= view.inverse_sigma.array();
  const double root_weight = std::sqrt(robustWeight(noise_.loss, r.norm(), noise_.loss_scale));
  const Eigen::Vector3d whiten = root_weight * view.inverse_sigma;
  r *= root_weight;
  const Eigen::Matrix3d J = -(whiten.asDiagonal() * camera_.projectionJacobian(p_cam));
  LinearView& linear = linear_.emplace_back();
  linear.B.leftCols<3>().noalias() = J * (T.rotation() * G);
  linear.B.col(3) << 0, 0, -whiten.z();
  addOuterProducts(linear.B, linear.B, V_);
  gradient_.noalias() += linear.B.transpose() * r;
  linear.J.col(7) = r;
  if (!with_poses) return true;
  linear.J.leftCols<3>() = J;
  linear.J.middleCols<3>(3).noalias() = -J * hat(p_cam);
  linear.J.col(6) << 0, 0, whiten.z();
  return true;
}

}  // namespace motorcade
