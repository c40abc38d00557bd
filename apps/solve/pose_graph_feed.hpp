#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "apps/solve/pose_graph_gauge.hpp"
#include "backend/solver/incremental_solver.hpp"

namespace motorcade {

/// Feeds a pose graph to the incremental solver in the order of the poses' ids, as if it were being driven. A pose
/// comes with all edges to present poses and starts at its odometry, whatever vertices the file lists. A pose that no
/// edge joins yet waits. Once an edge joins it, it enters with all that waited for it.
///
/// A tight prior holds the first pose of each connected part at the origin, and the solution is moved to the part's
/// gauge: chi2 does not depend on that. Where several poses are held, they are constants of the solver.
class PoseGraphFeed {
 public:
  enum class Pace {
    kByPose,  // an update per pose; where the graph has frames, an update per frame
    kAtOnce,  // everything in one update
  };
  struct Update {
    double cpu_ms = 0;  // of the thread, for adding variables and factors and for the solver's update
    int poses = 0, edges = 0;
    IncrementalSolver::Report report;
  };

  /// Poses that waited until `joining` came.
  struct LateJoin {
    std::int64_t joining;
    std::vector<std::int64_t> waited;
  };

  /// The solver's parameters for pose graphs.
  static IncrementalSolver::Params solverParams();

  /// Keeps a reference to the graph.
  PoseGraphFeed(const PoseGraph& graph, const IncrementalSolver::Params& params, Pace pace = Pace::kByPose);

  std::size_t updateCount() const { return update_ends_.size(); }
  bool atEnd() const { return updates_done_ == update_ends_.size(); }
  /// Feeds the next update; there must be one.
  Update next();
  /// Updates without anything new, for work that a budget put off.
  Update settle();

  IncrementalSolver& solver() { return solver_; }
  const IncrementalSolver& solver() const { return solver_; }

  /// Empty while the pose is no variable of the solver.
  std::optional<VariableId> variableOf(std::int64_t pose_id) const;
  std::int64_t poseOf(VariableId v) const { return index_.id(pose_of_variable_[v.value]); }

  std::size_t poseCount() const { return pose_of_variable_.size() + constants_; }  // in the solution
  std::size_t edgeCount() const { return edge_count_; }                            // in the solution
  const PoseGraphIndex& index() const { return index_; }
  const PoseGraphGauge& gauge() const { return gauge_; }
  /// Chi-square of the edges in the solver, at its estimate; without the prior.
  double chi2() const;
  /// Edges that the solver refused, as they are not finite at the values with which they entered: indices into the
  /// graph's.
  const std::vector<std::size_t>& refusedEdges() const { return refused_edges_; }
  const std::vector<LateJoin>& lateJoins() const { return late_joins_; }
  /// Problems of the solver's system in its current state.
  std::vector<SolverProblem> problemsNow() const;
  /// The ids of the poses fed so far, of each part but the main one.
  std::vector<std::vector<std::int64_t>> disconnectedParts() const;
  /// The estimates of all poses fed so far. A pose that no edge touches keeps its vertex.
  std::vector<PoseGraph::Vertex> vertices() const;

 private:
  using Neighbor = PoseGraphIndex::Neighbor;

  void feedPose(std::size_t pose, Update& update);
  std::optional<Neighbor> joinedTo(std::size_t pose) const;
  void addWithWaiting(std::size_t pose, const Neighbor& joint, Update& update);
  void add(std::size_t pose, const Value& initial, Update& update);
  Value moved(const Value& start, const Neighbor& from, std::size_t to) const;
  bool present(std::size_t pose) const { return variable_[pose].valid() || gauge_.isConstant(pose); }
  Value valueOf(std::size_t pose) const;
  std::unique_ptr<JacobianFactor> factorTo(std::size_t pose, const Neighbor& neighbor) const;
  void feedConstant(std::size_t pose, Update& update);
  PoseGraph::Pose moveOf(std::size_t part) const;
  std::vector<PoseGraph::Vertex> placedPart(std::size_t first, std::vector<char>& placed) const;

  const PoseGraph& graph_;
  PoseGraphIndex index_;
  PoseGraphGauge gauge_;
  IncrementalSolver solver_;
  std::vector<std::size_t> update_ends_;  // per update, the pose after its last
  std::size_t updates_done_ = 0, fed_ = 0, edge_count_ = 0, constants_ = 0;
  std::vector<VariableId> variable_;  // per pose; not valid while it is not in the solver
  std::vector<std::size_t> pose_of_variable_;
  std::vector<char> waits_;  // per pose
  std::vector<std::size_t> refused_edges_;
  std::vector<LateJoin> late_joins_;
};

}  // namespace motorcade
