#pragma once

#include <vector>

#include "apps/evaluate/object_matching.hpp"

namespace motorcade {

/// Whether errors are as large as the covariances say: over every fifth frame, 6 degrees of freedom each.
struct CovarianceErrors {
  int samples = 0;
  double mean_nees = 0;    // normalized estimation error squared; 6 when consistent
  double coverage_95 = 0;  // share inside the 95 % region
};

/// The camera's motion over kCameraCovarianceFrames.
CovarianceErrors cameraCovarianceErrors(const std::vector<ComparedFrame>& frames,
                                        const std::vector<RunFolder::CovarianceRow>& rows);
/// Objects relative to the camera of the same frame, without each track's constant offset between body and box frame.
CovarianceErrors objectCovarianceErrors(const std::vector<ComparedFrame>& frames,
                                        const std::vector<RunFolder::CovarianceRow>& rows);

}  // namespace motorcade
