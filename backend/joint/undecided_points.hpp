#pragma once

#include <array>
#include <span>
#include <vector>

#include "backend/joint/body_points.hpp"

namespace motorcade {

/// The latest views of points of which it is not known yet to what body they belong. Nobody can tell from a point's
/// first view, and a vehicle's points are known by how they move: their first views would be lost.
class UndecidedPoints {
 public:
  static constexpr int kMostViews = 4;  // that are kept of a point

  /// The points that are undecided in one frame, in frame order, ordered by point.
  void observe(FrameId frame, std::span<const PointMeasurement> points);
  /// The views of a point before `frame`, oldest first, now that its body is known; they are kept no longer. None when
  /// there were more than `most`: what does not show soon where it belongs may not belong there from the start.
  std::vector<LandmarkTrack::View> take(PointId point, FrameId frame, int most);

 private:
  /// There are many, and most of them live for a few frames: none has memory of its own.
  struct Known {
    PointId point;
    int count = 0;                                      // of views; none when they were taken
    std::array<LandmarkTrack::View, kMostViews> views;  // oldest first

    std::span<const LandmarkTrack::View> all() const { return std::span(views).first(static_cast<std::size_t>(count)); }
    void add(const LandmarkTrack::View& view);
  };

  TrackLife life_;
  std::vector<Known> known_;   // ordered by point
  std::vector<Known> merged_;  // memory for the next frame
};

}  // namespace motorcade
