#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "frontend/geometry/double_lanes.hpp"

namespace motorcade::test {

/// The vector in one lane.
inline Eigen::Vector3d lane(const Doubles3& v, std::size_t i) { return {v.x[i], v.y[i], v.z[i]}; }

}  // namespace motorcade::test
