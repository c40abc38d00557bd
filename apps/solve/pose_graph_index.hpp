#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "io/results/pose_graph.hpp"

namespace motorcade {

/// Numbers the poses of a graph from 0 in the order of their ids, and knows the edges at each.
class PoseGraphIndex {
 public:
  /// Keeps a reference to the graph.
  explicit PoseGraphIndex(const PoseGraph& graph);

  /// The pose at one edge's other end.
  struct Neighbor {
    std::size_t pose, edge;
  };
  /// Neighbors in the order of the file.
  std::span<const Neighbor> neighbors(std::size_t pose) const {
    return std::span(neighbors_).subspan(first_[pose], first_[pose + 1] - first_[pose]);
  }

  std::size_t size() const { return graph_.poses.size(); }
  std::int64_t id(std::size_t pose) const { return graph_.poses[pose]; }
  /// The pose with this id, or the first with a higher one.
  std::size_t at(std::int64_t id) const;
  /// The first pose with a higher id.
  std::size_t after(std::int64_t id) const;

 private:
  const PoseGraph& graph_;
  std::vector<Neighbor> neighbors_;  // those of each pose together
  std::vector<std::size_t> first_;   // per pose
};

}  // namespace motorcade
