#pragma once

#include "backend/smoother/trajectory_graph.hpp"

namespace motorcade {

/// Reads what a graph says about a frame of its window.
class EstimateReader {
 public:
  EstimateReader(TrajectoryGraph& graph, const Optimizer::Params& params) : graph_(graph), params_(params) {}

  /// Computes the covariances of a frame anew and keeps them in its records.
  void refreshCovariances(FrameId frame);
  /// Poses and velocities now, covariances as last computed.
  FrameEstimate read(FrameId frame) const;

 private:
  ObjectEstimate readObject(TrackId id, const ObjectTrack& track, FrameId frame) const;
  Eigen::Vector3d velocity(const ObjectTrack& track, FrameId frame) const;
  std::optional<Matrix6d> cameraCovariance(FrameId frame) const;
  void refreshObject(const ObjectTrack& track, ObjectRecord& record) const;

  TrajectoryGraph& graph_;
  const Optimizer::Params& params_;
};

}  // namespace motorcade
