#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>

#include "core/messages.hpp"
#include "core/se3.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/shape/outline.hpp"

namespace motorcade {

/// Remembers the left images of the last few frames, how the camera moved since, and where the objects were then.
class EarlierViews {
 public:
  static constexpr std::size_t kMost = 6;  // frames: half a second at 10 Hz, in which a person goes a step

  explicit EarlierViews(const StereoCamera& camera) : camera_(camera) {}

  /// Moves on to a new frame, seen or not. Call it before anything is asked of those before it.
  void move(const SE3& T_previous_now);
  /// Adds the frame that was moved to, for the frames to come.
  void add(const Features& features);
  /// Adds an object's pose in that frame, or in one before it.
  void addPlace(TrackId track, FrameId frame, const SE3& T_cam_body);

  /// The object's view in the last frame; empty where it had no place there.
  std::optional<ObjectView::Before> last(TrackId track, const ObjectView& view, const Features& now) const;
  /// The object's newest view in which body and rest are well apart, else the one in which they are farthest.
  std::optional<ObjectView::Before> wellApart(TrackId track, const ObjectView& view, const Features& now) const;
  /// Returns null where the object had no place in the frame.
  const SE3* place(TrackId track, FrameId frame) const;

 private:
  struct Frame {
    FrameId frame;
    ImagePyramid left;  // but for level 0, at which nobody compares
    SE3 T_then_now;
  };
  std::optional<ObjectView::Before> viewIn(const Frame& then, TrackId track, const ObjectView& view,
                                           const Features& now) const;

  StereoCamera camera_;
  std::deque<Frame> frames_;  // the oldest first
  std::map<TrackId, std::map<FrameId, SE3>> places_;
};

}  // namespace motorcade
