#include "backend/motion/camera_path.hpp"

#include <iterator>

namespace motorcade {
namespace {

constexpr std::size_t kKeptFrames = 64;

/// The covariance of a path that is one step longer.
Matrix6d extended(const Matrix6d& covariance, const SE3& T_previous_now, const Matrix6d& of_step) {
  const Matrix6d through = T_previous_now.inverse().adjoint();
  return through * covariance * through.transpose() + of_step;
}

}  // namespace

void CameraPath::add(const FrameMeasurements& measurements) {
  const SE3 T_previous_now =
      isFinite(measurements.odometry.T_previous_now) ? measurements.odometry.T_previous_now : SE3{};
  const Matrix6d& of_step = measurements.odometry.covariance;
  Camera camera{measurements.head.stamp, SE3{}, T_previous_now, of_step, Matrix6d::Zero()};
  if (!cameras_.empty()) {
    const Camera& before = cameras_.rbegin()->second;
    camera.T_world_cam = (before.T_world_cam * T_previous_now).normalized();
    camera.pose_covariance = extended(before.pose_covariance, T_previous_now, of_step);
  }
  cameras_[measurements.head.frame] = camera;
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
  for (auto it = std::next(from); it != std::next(to); ++it)
    covariance = extended(covariance, it->second.T_previous_now, it->second.odometry_covariance);
  return covariance;
}

}  // namespace motorcade
