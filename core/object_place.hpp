#pragma once

#include <Eigen/Core>

#include "core/messages.hpp"

namespace motorcade {

/// Place and heading of an object in the world. Their uncertainty is relative to the camera of the same frame: that of
/// the camera's own pose moves everything alike and is left out. Covariance and deviation are 0 where the estimate has
/// none.
struct ObjectPlace {
  Eigen::Vector3d center_world = Eigen::Vector3d::Zero();  // middle of the cuboid; of a body without, its origin
  Eigen::Matrix3d center_covariance = Eigen::Matrix3d::Zero();
  double heading_rad = 0;  // of the body's x axis, from the world's z axis to the left as seen from above
  double heading_sigma_rad = 0;
  Eigen::Vector3d centerSigma_m() const { return center_covariance.diagonal().cwiseMax(0).cwiseSqrt(); }
};

/// Propagates covariances: R is the rotation, xi = (rho, phi) the right perturbation of T_world_body, c the center in
/// the body frame, a = R e_x; the errors of cuboid and pose are taken as independent.
///   d center  = R (rho - [c]_x phi + dc)
///   d heading = d atan2(-a_x, a_z) = (a_x da_z - a_z da_x) / (a_x^2 + a_z^2),  da = -R [e_x]_x phi
ObjectPlace placeOf(const ObjectEstimate& object);

}  // namespace motorcade
