#include "frontend/shape/in_view.hpp"

#include <algorithm>

#include "frontend/shape/outline.hpp"

namespace motorcade {
namespace {

/// True when no part of a cuboid is in the left image, even if it is larger by a standard deviation at each side.
bool hasLeft(const ObjectBox& box, const SE3& T_cam_body, const StereoCamera& camera) {
  const Eigen::Vector3d half_m = 0.5 * box.size_m + box.size_sigma_m;
  return !projectedBox(box.center_body - half_m, box.center_body + half_m, T_cam_body, camera);
}

}  // namespace

bool isCutOff(const Box& points, const SE3& T_cam_body, const StereoCamera& camera) {
  constexpr double kBorder_px = 40;
  const double disparity_px = camera.fx_px * camera.baseline_m / T_cam_body.translation().z();
  return points.left_px < disparity_px + kBorder_px || points.right_px > camera.width_px - kBorder_px;
}

double shareInImages(const ObjectBox& box, const SE3& T_cam_body, const StereoCamera& camera) {
  constexpr double kNear_m = 1;
  const Eigen::Vector3d least = box.center_body - 0.5 * box.size_m, most = box.center_body + 0.5 * box.size_m;
  double left_px = 1e9, right_px = -1e9, hidden_px = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p_cam = T_cam_body * cornerOf(least, most, corner);
    if (p_cam.z() < kNear_m) return 0;
    const double u_px = camera.cx_px + camera.fx_px * p_cam.x() / p_cam.z();
    if (u_px < left_px) left_px = u_px, hidden_px = camera.fx_px * camera.baseline_m / p_cam.z();
    right_px = std::max(right_px, u_px);
  }
  return (std::min(right_px, camera.width_px - 1.0) - std::max(left_px, hidden_px)) / (right_px - left_px);
}

void dropLeft(FrameEstimate& frame, const StereoCamera& camera) {
  constexpr double kMostly = 0.5;
  std::erase_if(frame.objects, [&](const ObjectEstimate& object) {
    if (!object.cuboid) return false;
    const SE3 T_cam_body = frame.T_world_cam.inverse() * object.T_world_body;
    if (object.state != ObjectState::kPredicted) return hasLeft(*object.cuboid, T_cam_body, camera);
    return shareInImages(*object.cuboid, T_cam_body, camera) < kMostly;
  });
}

}  // namespace motorcade
