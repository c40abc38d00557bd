#pragma once

#include "backend/smoother/trajectory_graph.hpp"

namespace motorcade {

/// Reads what a graph says about a frame of its window. It changes nothing in the graph, which must outlive it.
class EstimateReader {
 public:
  explicit EstimateReader(const TrajectoryGraph& graph) : graph_(graph) {}

  /// Covariances of a frame, computed from the graph as it is now.
  FrameCovariances covariances(FrameId frame) const;
  /// Poses and velocities as the graph is now, with the covariances that its records hold.
  FrameEstimate read(FrameId frame) const;

 private:
  std::optional<Matrix6d> cameraCovariance(FrameId frame) const;
  std::optional<FrameCovariances::Object> objectCovariance(TrackId id, const ObjectTrack& track, FrameId frame) const;
  ObjectEstimate readObject(TrackId id, const ObjectTrack& track, FrameId frame) const;
  std::optional<Vector6d> meanTwist(const ObjectTrack& track, FrameId frame) const;

  const TrajectoryGraph& graph_;
};

}  // namespace motorcade
