#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/solve/pose_graph_index.hpp"

namespace motorcade {

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
