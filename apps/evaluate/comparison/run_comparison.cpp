#include "apps/evaluate/comparison/run_comparison.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace motorcade {
namespace {

/// The frames of `label` that are also in `other`.
FollowedLabel commonFrames(const FollowedLabel& label, const FollowedLabel& other) {
  std::set<FrameId> theirs;
  for (const auto& frame : other.frames) theirs.insert(frame.frame);
  FollowedLabel common = label;
  std::erase_if(common.frames, [&](const FollowedLabel::Frame& frame) { return !theirs.contains(frame.frame); });
  return common;
}

}  // namespace

double ComparedObject::relativeError(std::size_t kind) const {
  const double theirs_m = baseline.ate_m[kind].rmse;
  return theirs_m > 0 ? (theirs_m - ours.ate_m[kind].rmse) / theirs_m : 0;
}

RunComparison compareRuns(const std::vector<FollowedLabel>& ours, const std::vector<FollowedLabel>& baseline) {
  std::map<std::int64_t, ComparedObject> best;
  for (const auto& a : ours) {
    for (const auto& b : baseline) {
      if (a.label != b.label) continue;
      const auto mine = positionErrors(commonFrames(a, b)), theirs = positionErrors(commonFrames(b, a));
      ComparedObject& object = best[a.label];
      if (mine && theirs && mine->frames > object.ours.frames) object = {a.label, a.track, b.track, *mine, *theirs};
    }
  }
  RunComparison comparison;
  for (const auto& [label, object] : best) {
    if (object.ours.frames == 0) continue;
    comparison.objects.push_back(object);
    if (object.ours.frames < kLeastFramesOfMean) continue;
    ++comparison.objects_of_mean;
    for (std::size_t kind = 0; kind < kPositionKinds; ++kind)
      comparison.mean_relative_error[kind] += object.relativeError(kind);
  }
  for (double& mean : comparison.mean_relative_error) mean /= std::max(1, comparison.objects_of_mean);
  return comparison;
}

}  // namespace motorcade
