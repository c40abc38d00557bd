#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/matching/circular_matching.hpp"
#include "frontend/messages.hpp"
#include "frontend/motion/camera_trail.hpp"
#include "frontend/motion/coarse_localization.hpp"
#include "frontend/motion/point_track.hpp"
#include "frontend/motion/scene_flow.hpp"

namespace motorcade {

/// Prediction of a track for its point before the point is observed again.
struct KnownPoint {
  Eigen::Vector3d p_cam;  // in the newest camera of the trail, as if it were at rest since it was last observed
  Eigen::Matrix3d covariance;
  double disparity_px;  // when it was last observed
  PointLabel label;     // then
};

/// Tracks of scene points over the latest frames, each fitted as a point at rest and as a moving one. Call `update` in
/// frame order. No result refers to a track beyond the next `update`.
class PointTracks {
 public:
  struct Params {
    int max_missed_frames = 2;  // a point may be without disparity so long before its track ends
    SceneFlowEstimator::Params scene_flow;
  };
  PointTracks(const Params& params, const StereoCamera& camera);

  /// Returns one item per flow observation, empty for a new point. Call before the trail gets the frame of `flow`.
  std::vector<std::optional<KnownPoint>> known(const OpticalFlow& flow, const CameraTrail& trail) const;

  /// Extends the tracks by the newest frame of the trail and fits them anew. `observed` has one item per flow
  /// observation. A track ends when optical flow no longer follows its point.
  void update(const OpticalFlow& flow, const std::vector<std::optional<StereoObservation>>& observed,
              const CameraTrail& trail);

  /// Tracks that the last update extended, ordered by point: one per item of `observed` that is not empty. Valid until
  /// the next update.
  std::vector<std::reference_wrapper<const PointTrack>> observedNow() const;

  /// `points` are those of `observedNow`, with the labels that the segmentation gave them.
  void setLabels(std::span<const ScenePoint> points);

  /// Points of the last update that are not known to move, and the features of its frame; null before the first.
  std::vector<RestingPoint> seenLast() const;
  const FeaturesPtr& featuresOfLast() const { return features_; }

  /// Points at rest that were observed in an earlier frame and in the newest.
  std::vector<StereoCorrespondence> atRestSince(std::int64_t step) const;

  /// Adds to the disparities of all observations.
  void shiftDisparities(float change_px);

 private:
  bool isObservedNow(const PointTrack& track) const { return track.newest().step == step_; }

  std::vector<int> tracksOf(const OpticalFlow& flow) const;
  std::vector<std::size_t> keptPoints(std::span<const int> tracks,
                                      const std::vector<std::optional<StereoObservation>>& observed) const;
  std::optional<KnownPoint> knownPoint(const PointTrack& track, const CameraTrail& trail) const;
  void fit(PointTrack& track, const CameraTrail& trail, const Features& now) const;
  bool isFoundAtRest(const PointTrack& track, const CameraTrail& trail, const Features& now) const;

  Params params_;
  StereoCamera camera_;
  SceneFlowEstimator scene_flow_;
  std::vector<PointTrack> tracks_;   // ordered by point
  std::vector<PointTrack> updated_;  // memory for the next update
  std::int64_t step_ = -1;           // of the last update
  FeaturesPtr features_;             // of the last update
};

std::vector<Parameter> parametersOf(PointTracks::Params& params);

}  // namespace motorcade
