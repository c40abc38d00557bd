#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
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

/// Determines the gauge of a pose graph. Measured motions leave each connected part free to move as a whole: its poses
/// with a FIX line keep the values of their vertices, or its first pose does. A pose without a vertex that must be held
/// is held at the origin.
class PoseGraphGauge {
 public:
  struct Part {
    std::size_t first = 0;            // its pose of the lowest id
    std::size_t size = 0;             // poses
    std::vector<std::size_t> held{};  // one or more, ascending
  };
  /// A FIX line without effect.
  struct Unapplied {
    std::int64_t id = 0;
    enum class Why { kNoSuchPose, kNoVertex } why = Why::kNoSuchPose;
  };

  PoseGraphGauge(const PoseGraph& graph, const PoseGraphIndex& index);

  const std::vector<Part>& parts() const { return parts_; }  // by their first poses
  std::size_t partOf(std::size_t pose) const { return part_of_[pose]; }
  /// The main part of the graph: the first one with an edge, or else the first one.
  std::size_t mainPart() const { return main_part_; }
  /// Value of the pose's vertex, or the origin if it has none.
  PoseGraph::Pose valueOf(std::size_t pose) const;
  /// True for a constant: several poses of its part are held, and this is one of them.
  bool isConstant(std::size_t pose) const { return constant_[pose] != 0; }
  const std::vector<Unapplied>& unapplied() const { return unapplied_; }

 private:
  void findParts(const PoseGraphIndex& index);
  void hold(const PoseGraph& graph, const PoseGraphIndex& index);

  bool planar_;
  std::vector<Part> parts_;
  std::vector<std::size_t> part_of_;                    // per pose
  std::vector<std::optional<PoseGraph::Pose>> vertex_;  // per pose
  std::vector<char> constant_;                          // per pose
  std::size_t main_part_ = 0;
  std::vector<Unapplied> unapplied_;
};

}  // namespace motorcade
