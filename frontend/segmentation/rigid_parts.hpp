#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "frontend/messages.hpp"

namespace motorcade {

/// Covariance of the velocity of a point that carries scene flow.
Eigen::Matrix3d velocityCovariance(const ScenePoint& point);

/// Velocity that points have in common, and its covariance by their noise.
struct PooledVelocity {
  Eigen::Vector3d velocity_mps;
  Eigen::Matrix3d covariance;
};

/// Information-weighted mean velocity of points that carry scene flow. It starts from the component-wise median, which
/// outliers cannot move; what departs by more than `max_chi2` has less weight.
PooledVelocity poolVelocities(std::span<const int> members, const std::vector<ScenePoint>& points, double max_chi2);

/// Splits points that were taken for one body where they do not move as one. However a rigid body turns, its parts
/// keep their distance: along the line between two parts, their velocities are the same. Single points are too noisy to
/// tell, so parts are compared that are apart in depth. All `members` carry scene flow. Returns them as one part where
/// nothing speaks against a rigid body.
std::vector<std::vector<int>> rigidParts(std::span<const int> members, const std::vector<ScenePoint>& points);

}  // namespace motorcade
