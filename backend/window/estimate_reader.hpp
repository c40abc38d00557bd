#pragma once

#include "backend/window/smoothing_window.hpp"

namespace motorcade {

/// Reads the estimates of a window's frames. It changes nothing in the window, which must outlive it.
class EstimateReader {
 public:
  explicit EstimateReader(const SmoothingWindow& window, int motion_frames = kCameraCovarianceFrames)
      : window_(window), motion_frames_(motion_frames) {}

  /// Covariances of a frame, computed from the graph as it is now, with the errors of the calibration.
  FrameCovariances covariances(FrameId frame) const;
  /// Covariances of one object, see SmoothingWindow.
  std::optional<ObjectCovariances> covariances(const ObjectTrack& track, FrameId frame) const;
  /// Poses and velocities as the graph is now, with the covariances that its records hold.
  FrameEstimate read(FrameId frame) const;
  /// Frame at which the covariance of the camera's motion up to this one begins; empty where nothing links them.
  std::optional<FrameId> startOfMotion(FrameId frame) const;

 private:
  CameraCovariances cameraCovariances(FrameId frame) const;
  ObjectEstimate readObject(TrackId id, const ObjectTrack& track, FrameId frame) const;

  void consider(ObjectCovariances& covariances, const ObjectTrack& track, FrameId frame) const;

  const SmoothingWindow& window_;
  int motion_frames_;
};

}  // namespace motorcade
