#include "backend/motion/camera_path.hpp"

#include <iterator>

namespace motorcade {
namespace {

constexpr std::size_t kKeptFrames = 64;

}  // namespace

void CameraPath::add(const FrameMeasurements& measurements) {
  const SE3 T_previous_now =
      isFinite(measurements.odometry.T_previous_now) ? measurements.odometry.T_previous_now : SE3{};
  const SE3 T_world_cam =
      cameras_.empty() ? SE3{} : (cameras_.rbegin()->second.T_world_cam * T_previous_now).normalized();
  cameras_[measurements.head.frame] = {measurements.head.stamp, T_world_cam, T_previous_now,
                                       measurements.odometry.covariance};
  if (cameras_.size() > kKeptFrames) cameras_.erase(cameras_.begin());
}

const CameraPath::Camera* CameraPath::find(FrameId frame) const {
  const auto camera = cameras_.find(frame);
  return camera != cameras_.end() ? &camera->second : nullptr;
}

std::optional<Matrix6d> CameraPath::covarianceSince(FrameId since, FrameId now) const {
  const auto after = cameras_.upper_bound(since), to = cameras_.find(now);
  if (after == cameras_.begin() || to == cameras_.end()) return std::nullopt;
  const auto from = std::prev(after);
  Matrix6d covariance = Matrix6d::Zero();
  for (auto it = std::next(from); it != std::next(to); ++it) {
    const Matrix6d through = it->second.T_previous_now.inverse().adjoint();
    covariance = (through * covariance * through.transpose() + it->second.odometry_covariance).eval();
  }
  return covariance;
}

}  // namespace motorcade
