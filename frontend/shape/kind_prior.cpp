#include "frontend/shape/kind_prior.hpp"

#include "core/decompositions.hpp"
#include "core/elementary.hpp"

namespace motorcade {
namespace {

// The body's origin is the median of points on it, which mostly lie on the faces in view.
constexpr double kAsideSigma_m = 0.7, kBottom_m = -0.8, kBottomSigma_m = 0.5;

}  // namespace

FacePrior facePrior(const UsualSize& size, double ahead_sigma_m) {
  FaceInformation prior;
  for (int axis = 0; axis < 3; ++axis) {
    Vector6d difference = Vector6d::Zero();
    difference[2 * axis] = -1, difference[2 * axis + 1] = 1;
    prior.add(difference, size.mean_m[axis], size.sigma_m[axis]);
  }
  Vector6d ahead = Vector6d::Zero(), aside = Vector6d::Zero(), bottom = Vector6d::Zero();
  ahead[kRear] = ahead[kFront] = aside[kRight] = aside[kLeft] = 0.5;
  bottom[kBottom] = 1;
  prior.add(ahead, 0, hypotenuse(ahead_sigma_m, 0.25 * size.mean_m.x()));
  prior.add(aside, 0, kAsideSigma_m);
  prior.add(bottom, kBottom_m, kBottomSigma_m);
  return {prior, logDeterminant(Eigen::LLT<Matrix6d>(prior.H))};
}

double logDeterminant(const Eigen::LLT<Matrix6d>& llt) {
  const double root = Vector6d(llt.matrixLLT().diagonal()).prod();
  return 2 * logarithm(root);
}

}  // namespace motorcade
