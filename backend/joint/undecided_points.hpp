#pragma once

#include <array>
#include <span>
#include <vector>

#include "backend/joint/body_points.hpp"

namespace motorcade {

/// Latest views of points whose body is not known yet. A point's first view cannot tell its body, and a vehicle's
/// points are known by how they move: without this, their first views would be lost.
class UndecidedPoints {
 public:
  static constexpr int kMostViews = 4;  // that are kept of a point

  /// Adds the undecided points of one frame, in frame order, ordered by point.
  void observe(FrameId frame, std::span<const PointMeasurement> points);
  /// Takes the views of a point before `frame`, oldest first, now that its body is known. Returns none when there were
  /// more than `most`: a point that takes long to show its body may not have belonged to it from the start.
  std::vector<LandmarkTrack::View> take(PointId point, FrameId frame, int most);

 private:
  /// A known point. Most live for a few frames and they are many, so none has memory of its own.
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
