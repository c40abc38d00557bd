#pragma once

#include <optional>

#include <Eigen/Core>

namespace motorcade {

/// Roll, pitch and yaw [rad] of a rotation Rz(yaw) Ry(pitch) Rx(roll), the convention of ISO 8855. Roll is zero where
/// the pitch is a right angle, as only roll and yaw together are known there.
Eigen::Vector3d eulerAngles_rad(const Eigen::Matrix3d& rotation);

/// J in d(roll, pitch, yaw) = J dphi for a turn dphi about the rotated axes, R <- R exp(dphi). Empty within half a
/// degree of a vertical x axis, where the angles are not determined.
std::optional<Eigen::Matrix3d> eulerJacobian(const Eigen::Vector3d& angles_rad);

}  // namespace motorcade
