#pragma once

#include <memory>
#include <vector>

#include "core/parameters.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Follows scene points through the left images. Each point is aligned from frame to frame, coarse to fine and both
/// ways, then to its patch in a keyframe, so that errors do not add up from frame to frame. New points start at corners
/// where points are few. Features with descriptors (SIFT) are followed by those instead. Call in frame order. A frame
/// that is rejected, or in which hardly any point is found, gives no observations: the points wait for the next one,
/// for half a second at most. A change of the image size ends all points.
class OpticalFlowTracker {
 public:
  struct Params {
    int max_tracks = 2000;
    double max_round_trip_px = 0.5;  // from a point to where it is found forwards and back
    double max_flow_px = 250;        // per frame
  };
  static constexpr int kCell_px = 48;           // side of the cells over which new points are spread
  static constexpr double kMinDistance_px = 5;  // between points

  explicit OpticalFlowTracker(const Params& params);
  OpticalFlowTracker(OpticalFlowTracker&&) noexcept;
  OpticalFlowTracker& operator=(OpticalFlowTracker&&) noexcept;
  ~OpticalFlowTracker();

  OpticalFlowPtr operator()(const FeaturesPtr& features);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

std::vector<Parameter> parametersOf(OpticalFlowTracker::Params& params);

}  // namespace motorcade
