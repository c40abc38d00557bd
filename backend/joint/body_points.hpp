#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "backend/joint/landmark.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Observations of one point of a body in successive frames. Each observation is in one track only.
struct LandmarkTrack {
  PointId point;
  struct View {
    FrameId frame;
    Eigen::Vector3f uvd_px, sigma_px;
  };
  std::vector<View> views;                     // oldest first
  std::optional<LandmarkEstimate> estimate{};  // when it was fitted last
};

/// Tells which tracks have ended: their points were not seen for some frames. Frames that never came, or that showed
/// nothing, do not count.
class TrackLife {
 public:
  /// Adds a frame, in order.
  void add(FrameId frame);
  bool isLost(const LandmarkTrack::View& newest) const { return newest.frame < oldest_; }

 private:
  static constexpr std::size_t kMaxGap_frames = 3;
  std::deque<FrameId> frames_;  // the newest ones
  FrameId oldest_{0};           // in which a track that goes on may have been seen last
};

/// Chooses the landmarks of a body and cuts their tracks. A track ends when its point is lost. A track with as many
/// views as it may have gives most of them away as a track that ended; a few may stay, so that the landmark stays the
/// same. Each observation counts once.
class BodyPoints {
 public:
  struct Params {
    int max_views = 10;  // of a track
    /// Age of the oldest views that a cut leaves. They lie in few frames, the same for all tracks, and fewer farther
    /// back.
    int oldest_kept_frames = 0;
    int max_landmarks = 300;  // followed at a time
    int half = 0;             // 1 and 2 take the points with odd and even ids only
    int image_width_px = 0, image_height_px = 0;
  };
  explicit BodyPoints(const Params& params) : params_(params) {}

  /// Views that a point had before it was known to be the body's, oldest first.
  using EarlierViews = std::function<std::vector<LandmarkTrack::View>(PointId)>;

  /// Adds the body's points in one frame, in frame order, ordered by point.
  void observe(FrameId frame, std::span<const PointMeasurement> points, const EarlierViews& earlier = {});
  /// Forgets tracks that have not ended, of points that belong to another body.
  void forget(std::span<const PointMeasurement> points);

  /// Ends the tracks with views in frames up to this one. Every other of their newest views goes on as a track.
  void endFrom(FrameId oldest);
  /// Takes the tracks that ended since the last call, with two views and more.
  std::vector<LandmarkTrack> takeEnded();
  /// The chosen landmarks whose tracks go on, with two views and more.
  std::vector<LandmarkTrack*> current();
  /// The chosen landmarks that were seen in the newest frame.
  std::vector<LandmarkTrack*> seenNow();

 private:
  struct Candidate {
    LandmarkTrack track;
    bool chosen = false;
  };
  void extend(Candidate& candidate, const LandmarkTrack::View& view);
  void cut(Candidate& candidate);
  template <class Stays>
  void split(Candidate& candidate, const Stays& stays);
  bool isKept(FrameId frame) const;
  void end(Candidate& candidate);
  void choose();
  int cellOf(const Candidate& candidate) const;

  Params params_;
  FrameId newest_;
  TrackLife life_;
  std::vector<Candidate> candidates_;  // ordered by point
  std::vector<Candidate> merged_;      // memory for the next frame
  std::vector<LandmarkTrack> ended_;
};

}  // namespace motorcade
