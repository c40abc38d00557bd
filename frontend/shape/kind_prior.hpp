#pragma once

#include <Eigen/Cholesky>

#include "frontend/shape/box_belief.hpp"

namespace motorcade {

/// Length, width and height of a kind, and how they vary.
struct UsualSize {
  Eigen::Vector3d mean_m, sigma_m;
};

/// Prior of the faces of a kind, before anything is seen.
struct FacePrior {
  FaceInformation faces;
  double log_determinant;
};

/// Prior of faces around the body's origin. It lies within `ahead_sigma_m` of the middle between rear and front, or
/// within a quarter of the length.
FacePrior facePrior(const UsualSize& size, double ahead_sigma_m);

double logDeterminant(const Eigen::LLT<Matrix6d>& llt);

}  // namespace motorcade
