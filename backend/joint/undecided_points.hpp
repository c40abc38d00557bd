#pragma once

#include <span>
#include <vector>

#include "backend/joint/body_points.hpp"

namespace motorcade {

/// The latest views of points of which it is not known yet to what body they belong. Nobody can tell from a point's
/// first view, and a vehicle's points are known by how they move: their first views would be lost.
class UndecidedPoints {
 public:
  /// Keeps `most_views` of each point.
  explicit UndecidedPoints(int most_views) : most_views_(most_views) {}

  /// The points that are undecided in one frame, in frame order, ordered by point.
  void observe(FrameId frame, std::span<const PointMeasurement> points);
  /// The views of a point before `frame`, oldest first, now that its body is known; they are kept no longer. None when
  /// there were more than `most`: what does not show soon where it belongs may not belong there from the start.
  std::vector<LandmarkTrack::View> take(PointId point, FrameId frame, int most);

 private:
  int most_views_;
  TrackLife life_;
  std::vector<LandmarkTrack> known_;   // ordered by point; without views when they were taken
  std::vector<LandmarkTrack> merged_;  // memory for the next frame
};

}  // namespace motorcade
