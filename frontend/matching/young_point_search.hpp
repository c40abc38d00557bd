#pragma once

#include <optional>

#include "frontend/matching/corner_lookup.hpp"
#include "frontend/matching/neighbor_shifts.hpp"
#include "frontend/matching/point_follower.hpp"

namespace motorcade {

/// Finds points whose own velocity tells nothing: new ones, and those that did not keep theirs. Guesses come from their
/// neighbors and from corners that look like them, first near ones, then far ones. It refers to what it was made with.
class YoungPointSearch {
 public:
  /// `neighbors` are the points that were found in `now` already.
  YoungPointSearch(const PointFollower& follower, const Features& before, const Features& now, NeighborShifts neighbors,
                   double max_flow_px);

  /// Finds a point of the frame before; empty when it is not found.
  std::optional<AlignedPatch> operator()(const FlowObservation& point) const;

 private:
  const PointFollower& follower_;
  const ImagePyramid& before_;
  CornerLookup corners_;
  NeighborShifts neighbors_;
  double max_flow_px_;
};

}  // namespace motorcade
