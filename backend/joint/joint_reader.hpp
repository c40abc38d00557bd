#pragma once

#include <optional>

#include "backend/joint/joint_graph.hpp"

namespace motorcade {

/// Reads what a graph says about a frame of its window. It changes nothing in the graph, which must outlive it.
class JointReader {
 public:
  explicit JointReader(const JointGraph& graph) : graph_(graph) {}

  /// Covariances of a frame, computed from the graph as it is now.
  JointCovariances covariances(FrameId frame) const;
  /// Poses and velocities as the graph is now, with the covariances that its records hold.
  FrameEstimate read(FrameId frame) const;

 private:
  std::optional<Matrix6d> cameraCovariance(FrameId frame) const;
  std::optional<JointCovariances::Object> objectCovariance(TrackId id, const JointObject& object,
                                                           const JointRecord& record) const;
  ObjectEstimate readObject(TrackId id, const JointObject& object, FrameId frame) const;

  const JointGraph& graph_;
};

}  // namespace motorcade
