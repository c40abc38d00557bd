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

/// Misfit of a usual size with the least size that points leave to a body, as a chi-square value.
double misfitOf(const UsualSize& size, const BodyTraits& traits);

double logDeterminant(const Eigen::LLT<Matrix6d>& llt);

/// Cuboid and belief in it: its kind, `unknown` unless one is likelier than 0.6, the probability of the likeliest kind,
/// named or not, and the standard deviations that remain.
///
/// The belief is a mixture of Gaussians. Each kind has its usual sizes and speeds and a share of what moves on streets;
/// besides, the object may be something else. All looks at it may be wrong by the same amount: as bodies are no
/// cuboids, or as an outline holds more than the object, or less. Standard deviations are around the cuboid, over the
/// whole mixture.
ObjectBox believedBox(const FaceInformation& evidence, const BodyTraits& traits);

/// The likelier kind of pedestrian and two-wheeler, where its probability is `least` or more; `unknown` elsewhere.
ObjectKind smallKind(const FaceInformation& evidence, const BodyTraits& traits, double least);

}  // namespace motorcade
