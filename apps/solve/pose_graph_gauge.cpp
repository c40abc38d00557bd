#include "apps/solve/pose_graph_gauge.hpp"

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

PoseGraphGauge::PoseGraphGauge(const PoseGraph& graph, const PoseGraphIndex& index)
    : planar_(graph.planar), part_of_(index.size(), index.size()), vertex_(index.size()), constant_(index.size(), 0) {
  for (const auto& vertex : graph.vertices) vertex_[index.at(vertex.id)] = vertex.pose;
  findParts(index);
  hold(graph, index);
}

void PoseGraphGauge::findParts(const PoseGraphIndex& index) {
  std::vector<std::size_t> open;
  for (std::size_t first = 0; first < index.size(); ++first) {
    if (part_of_[first] != index.size()) continue;
    Part part{.first = first};
    part_of_[first] = parts_.size();
    for (open.assign(1, first); !open.empty(); ++part.size) {
      const std::size_t pose = open.back();
      open.pop_back();
      for (const auto& neighbor : index.neighbors(pose)) {
        if (part_of_[neighbor.pose] != index.size()) continue;
        part_of_[neighbor.pose] = parts_.size();
        open.push_back(neighbor.pose);
      }
    }
    parts_.push_back(part);
  }
  const auto main = std::ranges::find_if(parts_, [](const Part& part) { return part.size > 1; });
  main_part_ = main == parts_.end() ? 0 : static_cast<std::size_t>(main - parts_.begin());
}

void PoseGraphGauge::hold(const PoseGraph& graph, const PoseGraphIndex& index) {
  std::vector<std::int64_t> fixed = graph.fixed;
  std::ranges::sort(fixed);
  fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
  std::vector<std::size_t> without_vertex;
  for (const std::int64_t id : fixed) {
    const std::size_t pose = index.at(id);
    if (pose == index.size() || index.id(pose) != id) {
      unapplied_.push_back({id, Unapplied::Why::kNoSuchPose});
    } else if (vertex_[pose]) {
      parts_[part_of_[pose]].held.push_back(pose);
    } else {
      without_vertex.push_back(pose);
    }
  }
  for (const std::size_t pose : without_vertex) {
    auto& held = parts_[part_of_[pose]].held;
    if (held.empty()) {
      held.push_back(pose);
    } else {
      unapplied_.push_back({index.id(pose), Unapplied::Why::kNoVertex});
    }
  }
  for (Part& part : parts_) {
    if (part.held.empty()) part.held.push_back(part.first);
    for (const std::size_t pose : part.held) constant_[pose] = part.held.size() > 1 ? 1 : 0;
  }
}

PoseGraph::Pose PoseGraphGauge::valueOf(std::size_t pose) const {
  return vertex_[pose].value_or(planar_ ? PoseGraph::Pose(SE2{}) : PoseGraph::Pose(SE3{}));
}

}  // namespace motorcade
