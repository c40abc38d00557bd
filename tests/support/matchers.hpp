#pragma once

#include <Eigen/Core>
#include <gmock/gmock.h>

#include "core/se3.hpp"

namespace motorcade::test {

/// Largest absolute difference of two matrices of equal shape is below `tolerance`.
MATCHER_P2(IsNear, expected, tolerance, "") {
  const double difference = (arg - expected).cwiseAbs().maxCoeff();
  *result_listener << "largest difference " << difference << "\nactual\n" << arg << "\nexpected\n" << expected;
  return difference <= tolerance;
}

/// Two rigid motions differ by less than `tolerance` in log(expected^-1 * actual).
MATCHER_P2(IsNearPose, expected, tolerance, "") {
  const double difference = (expected.inverse() * arg).log().norm();
  *result_listener << "differs by " << difference;
  return difference <= tolerance;
}

}  // namespace motorcade::test
