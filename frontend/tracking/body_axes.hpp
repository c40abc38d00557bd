#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/se3.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// The road's normal, away from the ground.
inline Eigen::Vector3d upInWorld(const SceneMotion& scene, const SE3& T_world_cam) {
  return -(T_world_cam.rotation() * scene.ground.normal_cam);
}

/// Body axes for a direction of travel: x ahead over the ground, z up, y to the left.
inline Eigen::Matrix3d travelAxes(const Eigen::Vector3d& velocity, const Eigen::Vector3d& up) {
  const Eigen::Vector3d ahead = (velocity - up * up.dot(velocity)).normalized();
  Eigen::Matrix3d R;
  R << ahead, up.cross(ahead), up;
  return R;
}

}  // namespace motorcade
