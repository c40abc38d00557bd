#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace motorcade {

/// Connected components of the Delaunay graph over image points, without the edges that `belong_together` denies. Each
/// is ordered by index, and they are ordered by their first index. Points at the same pixel belong together without
/// being asked.
std::vector<std::vector<int>> cutDelaunayComponents(std::span<const Eigen::Vector2d> points_px,
                                                    const std::function<bool(int, int)>& belong_together);

}  // namespace motorcade
