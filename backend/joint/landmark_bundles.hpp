#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "backend/joint/frame_index.hpp"
#include "backend/joint/rig_offset.hpp"
#include "backend/joint/rig_shake.hpp"

namespace motorcade {

/// Landmarks of one body, and the factors that hold their views' information on the poses from which they were seen.
/// One factor over the tracks that go on is made anew in each update; lasting ones hold the tracks that ended.
class LandmarkBundles {
 public:
  struct Params {
    FramePose pose = FramePose::kWorldCam;
    LandmarkNoise noise;
    BodyPoints::Params points;
    IncrementalSolver::Lifetime newest = IncrementalSolver::Lifetime::kLasting;  // of the factor over the newest tracks
    int closing_frames = 5;      // tracks that ended in so many frames share a factor
    bool from_estimates = true;  // landmarks are fitted from where they were found before, not from the newest view
    bool tells_shake = true;     // they are many enough to tell each frame's shake, not only corrected by it
  };
  LandmarkBundles(const Params& params, const NoiseLevel& noise, const StereoCamera& camera, IncrementalSolver& solver,
                  const RigOffset& offset, RigShake& shake);

  BodyPoints& points() { return points_; }
  const NoiseLevel& noise() const { return noise_; }
  double designEffect() const { return noise_.designEffect(neighbors_per_view_); }
  bool hasNewest() const { return newest_.has_value(); }

  /// Makes the factor over the tracks that go on, and over those that ended lately, anew. In one of some frames ended
  /// tracks get a lasting factor, and at once if they have views in frames up to `leaving`, which leave the graph
  /// before the next call. `frame_count` counts the frames of the drive from zero.
  void renew(std::int64_t frame_count, const PoseVariable& pose_variable, FrameId leaving = {});
  /// Makes the factors over ended tracks anew, as the offset has moved.
  void relinearize(const PoseVariable& pose_variable);
  /// Fixes the factors over ended tracks.
  void fix() { closed_.clear(); }
  /// Forgets what frames up to this one told, as they leave the graph. `renew` was told before, and its lasting factors
  /// keep what they say of the frames that stay.
  void retire(FrameId oldest);
  /// Forgets the body's poses, which have gone, and the factors with them.
  void drop();

 private:
  /// Tracks that ended, and the factor that holds them.
  struct Closed {
    FactorId factor;
    FrameId first;  // of their views
    std::vector<LandmarkTrack> tracks;
  };
  struct Bundle {
    FactorId factor;
    std::vector<FrameId> frames;
    std::vector<FrameShake> shakes;  // of the frames, where the landmarks tell them
  };
  /// Landmarks with at least two views from poses in the graph, and their tracks.
  struct Gathered {
    FrameIndex index;
    LandmarkViews landmarks;
    std::vector<LandmarkTrack*> tracks;
  };
  void closeEnded(const PoseVariable& pose_variable);
  Gathered gather(std::span<LandmarkTrack* const> tracks, const PoseVariable& pose_variable) const;
  std::optional<Bundle> addBundle(const Gathered& gathered, IncrementalSolver::Lifetime lifetime);
  std::vector<SE3> posesFromCamera(const FrameIndex& index) const;

  Params params_;
  const StereoCamera& camera_;
  IncrementalSolver& solver_;
  const RigOffset& offset_;
  RigShake& shake_;
  BodyPoints points_;
  NoiseLevel noise_;
  double neighbors_per_view_ = 0;     // in the newest factor
  std::vector<LandmarkTrack> ended_;  // whose factor for good is still to be made
  std::optional<Bundle> newest_;      // over these and the tracks that go on
  std::vector<Closed> closed_;        // while the offset may still move
};

}  // namespace motorcade
