#include "apps/solve/pose_graph_index.hpp"

#include <algorithm>

namespace motorcade {

PoseGraphIndex::PoseGraphIndex(const PoseGraph& graph)
    : graph_(graph), neighbors_(2 * graph.edges.size()), first_(graph.poses.size() + 1, 0) {
  std::vector<std::pair<std::size_t, std::size_t>> ends;
  ends.reserve(graph.edges.size());
  for (const auto& edge : graph.edges) ends.emplace_back(at(edge.from), at(edge.to));
  for (const auto& [from, to] : ends) ++first_[from + 1], ++first_[to + 1];
  for (std::size_t pose = 0; pose < size(); ++pose) first_[pose + 1] += first_[pose];
  std::vector<std::size_t> next(first_.begin(), first_.end());
  for (std::size_t edge = 0; edge < ends.size(); ++edge) {
    const auto& [from, to] = ends[edge];
    neighbors_[next[from]++] = {to, edge};
    neighbors_[next[to]++] = {from, edge};
  }
}

std::size_t PoseGraphIndex::at(std::int64_t id) const {
  return std::ranges::lower_bound(graph_.poses, id) - graph_.poses.begin();
}

std::size_t PoseGraphIndex::after(std::int64_t id) const {
  return std::ranges::upper_bound(graph_.poses, id) - graph_.poses.begin();
}

}  // namespace motorcade
