#pragma once

#include <vector>

#include "apps/evaluate/measures/axis_reliability.hpp"
#include "core/se3.hpp"

/// Compares errors with the covariances that were estimated for them.
namespace motorcade {

/// truth = estimate * exp(xi), xi ~ (0, covariance).
struct ErrorSample {
  Vector6d xi;
  Matrix6d covariance;
};

/// Normalized estimation errors squared, xi' covariance^-1 xi. Their mean is the number of degrees of freedom where
/// errors and covariances agree. The median shows whether a few frames or all of them are off.
struct NormalizedErrors {
  double mean_nees = 0, median_nees = 0;
  double coverage_95 = 0;  // share inside the 95 % region
};

struct CovarianceErrors {
  int samples = 0;
  NormalizedErrors pose;                // 6 degrees of freedom
  NormalizedErrors position, rotation;  // 3 each, by the blocks of the covariance
  AxisReliability by_axis;
};
/// Samples whose covariance is not positive definite are left out.
CovarianceErrors consistencyOf(const std::vector<ErrorSample>& samples);

/// The same body as two estimates see it from a camera, with a constant between their body frames: T_cam_body =
/// T_cam_other * Y. Right perturbations; a label has no covariance.
struct SeenTwice {
  SE3 T_cam_body, T_cam_other;
  Matrix6d covariance, other_covariance = Matrix6d::Zero();
};
/// The errors log(T_cam_body^-1 * T_cam_other * Y) of all frames with their covariances. Y minimizes them, weighted by
/// the covariances, so that uncertain frames do not bend what other frames know well.
std::vector<ErrorSample> errorsWithoutOffset(const std::vector<SeenTwice>& frames);

}  // namespace motorcade
