#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include <Eigen/Core>

namespace motorcade::test {

/// Positions on the grid of 1/16 px that triangulations are exact on. All below is exact for points less than 2^14 grid
/// steps apart.
using Whole = std::int64_t;
struct Grid {
  Whole x, y;
};
inline Grid onGrid(const Eigen::Vector2d& p) { return {std::llround(16 * p.x()), std::llround(16 * p.y())}; }

/// Positive when a, b, c turn clockwise as seen in the image.
inline Whole turn(const Grid& a, const Grid& b, const Grid& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Side of the circle of a clockwise triangle a, b, c: positive with d strictly inside, zero with d on it.
inline Whole circleSide(const Grid& a, const Grid& b, const Grid& c, const Grid& d) {
  const auto lift = [&](const Grid& p) { return (p.x - d.x) * (p.x - d.x) + (p.y - d.y) * (p.y - d.y); };
  const auto cross = [&](const Grid& p, const Grid& q) {
    return (p.x - d.x) * (q.y - d.y) - (p.y - d.y) * (q.x - d.x);
  };
  return lift(a) * cross(b, c) + lift(b) * cross(c, a) + lift(c) * cross(a, b);
}

/// Edges (i, j), i < j, of the Delaunay triangulation, by the definition: triangles whose circle is empty. Empty where
/// the triangulation is not unique: three points on a line, or four on an empty circle. Takes O(n^4).
inline std::optional<std::set<std::array<int, 2>>> delaunayEdgesByDefinition(const std::vector<Grid>& points) {
  std::set<std::array<int, 2>> edges;
  const auto n = static_cast<int>(points.size());
  const auto at = [&](int i) { return points[i]; };
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      for (int k = j + 1; k < n; ++k) {
        const Whole orientation = turn(at(i), at(j), at(k));
        if (orientation == 0) return std::nullopt;
        Whole nearest = -1;  // positive with a point inside the circle, zero with one on it
        for (int l = 0; nearest <= 0 && l < n; ++l)
          if (l != i && l != j && l != k)
            nearest = std::max(nearest, orientation > 0 ? circleSide(at(i), at(j), at(k), at(l))
                                                        : circleSide(at(i), at(k), at(j), at(l)));
        if (nearest == 0) return std::nullopt;
        if (nearest < 0) edges.insert({{i, j}, {i, k}, {j, k}});
      }
    }
  }
  return edges;
}

}  // namespace motorcade::test
