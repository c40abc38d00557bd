#pragma once

#include <map>
#include <span>
#include <vector>

#include "backend/joint/joint_params.hpp"
#include "backend/joint/known_landmarks.hpp"
#include "backend/joint/landmark_bundles.hpp"
#include "backend/window/smoothing_window.hpp"

namespace motorcade {

/// Landmarks of the world, which tell how the camera moves. They are many, and eliminated in one of some frames. In the
/// other frames they stay where they were found, and the newest camera is aligned to them; the next elimination takes
/// that back.
class LandmarksAtRest {
 public:
  using Frames = std::map<FrameId, CameraRecord>;  // of the window, with the newest

  LandmarksAtRest(const JointParams& params, const StereoCamera& camera, IncrementalSolver& solver,
                  const RigOffset& offset, RigShake& shake);

  LandmarkBundles& bundles() { return bundles_; }
  const NoiseLevel& noise() const { return bundles_.noise(); }
  /// Factor by which variances grow, see NoiseLevel.
  double designEffect() const { return bundles_.designEffect(); }
  /// Number of landmarks of the newest frame that were seen before.
  int seenAgain();

  /// Links the newest camera; `frame_count` counts the frames of the drive from zero. Frames up to `leaving` leave the
  /// graph before landmarks are eliminated again.
  void add(std::int64_t frame_count, const Frames& frames, FrameId leaving);
  /// Eliminates the landmarks to which the newest cameras are aligned. Returns false when there is nothing to do.
  bool eliminateAligned(std::int64_t frame_count, const Frames& frames);
  void relinearize(const Frames& frames);

 private:
  void eliminate(std::int64_t frame_count, const Frames& frames, FrameId leaving = {});
  std::optional<FactorId> alignNewest(const Frames& frames);
  std::vector<ViewOfKnown> knownViews(std::span<LandmarkTrack* const> tracks, const FrameIndex& index,
                                      std::span<const SE3> T_cam_world, FrameId before);

  const JointParams& params_;
  const StereoCamera& camera_;
  IncrementalSolver& solver_;
  const RigOffset& offset_;
  RigShake& shake_;
  LandmarkBundles bundles_;
  std::vector<FactorId> alignments_;  // of cameras, since landmarks were eliminated
};

/// Camera variables of the frames, which must outlive this.
PoseVariable camerasOf(const LandmarksAtRest::Frames& frames);

}  // namespace motorcade
