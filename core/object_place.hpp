#pragma once

#include <Eigen/Core>

#include "core/messages.hpp"

namespace motorcade {

/// Where an object stands and heads in the world, with what is unsure of both relative to the camera of the same
/// frame: that of the camera's own pose is left out, as it moves everything alike. Covariance and deviation are 0 where
/// the estimate has none.
struct ObjectPlace {
  Eigen::Vector3d center_world = Eigen::Vector3d::Zero();  // middle of the cuboid; of a body without, its origin
  Eigen::Matrix3d center_covariance = Eigen::Matrix3d::Zero();
  double heading_rad = 0;  // of the body's x axis, from the world's z axis to the left as seen from above
  double heading_sigma_rad = 0;
  Eigen::Vector3d centerSigma_m() const { return center_covariance.diagonal().cwiseMax(0).cwiseSqrt(); }
};

/// With R the rotation and xi = (rho, phi) the right perturbation of T_world_body, c the center in the body frame,
/// a = R e_x, and the errors of cuboid and pose taken as independent:
///   d center  = R (rho - [c]_x phi + dc)
///   d heading = d atan2(-a_x, a_z) = (a_x da_z - a_z da_x) / (a_x^2 + a_z^2),  da = -R [e_x]_x phi
ObjectPlace placeOf(const ObjectEstimate& object);

}  // namespace motorcade
