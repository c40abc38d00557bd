#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace motorcade {

/// The Delaunay graph over image points with the edges cut that `belong_together` denies: its connected components,
/// each ordered by index, ordered by their first index. Points at the same pixel belong together without being asked.
std::vector<std::vector<int>> cutDelaunayComponents(std::span<const Eigen::Vector2d> points_px,
                                                    const std::function<bool(int, int)>& belong_together);

}  // namespace motorcade
