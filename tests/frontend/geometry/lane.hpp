#pragma once

#include <Eigen/Core>

#include "frontend/geometry/lane_algebra.hpp"

namespace motorcade::test {

/// The vector in one lane.
inline Eigen::Vector3d lane(const HWY_NAMESPACE::Doubles3& v, int i) { return {v.x[i], v.y[i], v.z[i]}; }

}  // namespace motorcade::test
