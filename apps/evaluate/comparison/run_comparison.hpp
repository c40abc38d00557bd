#pragma once

#include <array>
#include <vector>

#include "apps/evaluate/comparison/object_positions.hpp"

namespace motorcade {

/// One label over the frames in which both runs followed it, by the two tracks with the most common frames.
struct ComparedObject {
  std::int64_t label = -1;
  TrackId track, baseline_track;
  PositionErrors ours, baseline;
  /// (ATE_baseline - ATE_ours) / ATE_baseline, of root mean squares.
  double relativeError(std::size_t kind) const;
};

struct RunComparison {
  std::vector<ComparedObject> objects;
  int objects_of_mean = 0;  // followed in at least `kLeastFramesOfMean` common frames
  std::array<double, kPositionKinds> mean_relative_error{};
};
/// Compares two runs of the same drive. Labels that only one of them followed are left out.
RunComparison compareRuns(const std::vector<FollowedLabel>& ours, const std::vector<FollowedLabel>& baseline);

}  // namespace motorcade
