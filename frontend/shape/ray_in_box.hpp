#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>

namespace motorcade {

struct Interval {
  double begin, end;
};

/// Interval of a ray, origin + t * direction, within a box; empty intervals end before they begin.
inline Interval insideOf(const Eigen::Vector3d& least, const Eigen::Vector3d& most, const Eigen::Vector3d& origin,
                         const Eigen::Vector3d& direction) {
  Interval inside{0, 1e9};
  for (int axis = 0; axis < 3; ++axis) {
    const double inverse = 1 / (std::abs(direction[axis]) > 1e-9 ? direction[axis] : 1e-9);
    double in = (least[axis] - origin[axis]) * inverse, out = (most[axis] - origin[axis]) * inverse;
    if (in > out) std::swap(in, out);
    inside.begin = std::max(inside.begin, in);
    inside.end = std::min(inside.end, out);
  }
  return inside;
}

}  // namespace motorcade
