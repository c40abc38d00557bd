#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace motorcade {

/// Neighborhood of image points. A vertex is named by the index of its point; points that coincide share the index of
/// the first one.
struct DelaunayGraph {
  std::vector<int> vertex_of_point;           // per point: itself, or the first point at the same position
  std::vector<std::array<int, 2>> edges;      // (i, j), i < j, sorted
  std::vector<std::array<int, 3>> triangles;  // clockwise in the image (v down), smallest index first, sorted
};

/// Delaunay triangulation by divide and conquer (Guibas, Stolfi 1985). Exact for positions rounded to 1/16 px, within
/// +/-2^24 px. Collinear points give the chain of edges along their line; fewer than two distinct points give no edge.
/// The triangles are left out without `with_triangles`.
DelaunayGraph delaunay(std::span<const Eigen::Vector2d> points_px, bool with_triangles = true);

}  // namespace motorcade
