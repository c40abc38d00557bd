#pragma once

#include <Eigen/Core>

#include "core/se3.hpp"
#include "core/timestamp.hpp"

namespace osi3 {
class BaseMoving;
class Dimension3d;
class Orientation3d;
class Timestamp;
class Vector3d;
}  // namespace osi3

/// Fields that OSI's messages share.
namespace motorcade {

void set(osi3::Timestamp* message, Timestamp stamp);
void set(osi3::Vector3d* message, const Eigen::Vector3d& vector);
void set(osi3::Dimension3d* message, const Eigen::Vector3d& size_m);
/// Roll, pitch, yaw.
void set(osi3::Orientation3d* message, const Eigen::Vector3d& angles_rad);
/// Position and orientation.
void set(osi3::BaseMoving* message, const SE3& T_parent_box);

/// The standard deviations from a covariance's diagonal.
Eigen::Vector3d sigmasOf(const Eigen::Matrix3d& covariance);

/// Standard deviations of roll, pitch and yaw of a rotation whose perturbation on the right has this covariance; none
/// where the x axis is vertical.
void setAngleErrors(osi3::BaseMoving* message, const Eigen::Matrix3d& rotation, const Eigen::Matrix3d& turn_covariance);

/// The rates of roll, pitch and yaw of a rotation that turns with this rate about its own axes; none where the x axis
/// is vertical.
void setAngleRates(osi3::BaseMoving* message, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& turn_radps);

}  // namespace motorcade
