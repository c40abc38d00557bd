#include "frontend/segmentation/motion_graph.hpp"

#include <numeric>

#include "frontend/geometry/delaunay.hpp"

namespace motorcade {
namespace {

/// Union-find with path halving.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int find(int i) {
    while (at(i) != i) i = at(i) = at(at(i));
    return i;
  }
  /// The smaller root stays, so that a component is named by its first member.
  void join(int i, int j) {
    i = find(i);
    j = find(j);
    if (i < j) at(j) = i;
    if (j < i) at(i) = j;
  }

 private:
  int& at(int i) { return parent_[i]; }
  std::vector<int> parent_;
};

}  // namespace

std::vector<std::vector<int>> cutDelaunayComponents(std::span<const Eigen::Vector2d> points_px,
                                                    const std::function<bool(int, int)>& belong_together) {
  const auto n = static_cast<int>(points_px.size());
  DisjointSets sets(points_px.size());
  const DelaunayGraph graph = delaunay(points_px, false);
  for (int i = 0; i < n; ++i) sets.join(i, graph.vertex_of_point[i]);
  for (const auto& [i, j] : graph.edges)
    if (sets.find(i) != sets.find(j) && belong_together(i, j)) sets.join(i, j);

  std::vector<std::vector<int>> members(points_px.size());
  for (int i = 0; i < n; ++i) members[sets.find(i)].push_back(i);
  std::erase_if(members, [](const auto& m) { return m.empty(); });
  return members;
}

}  // namespace motorcade
