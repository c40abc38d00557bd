#include "apps/evaluate/measures/segment_errors.hpp"

#include <algorithm>
#include <cassert>

#include "apps/evaluate/comparison/trajectory_error.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kFramesBetweenSegments = 10;
constexpr double kLeastForLongSegments_m = 300;  // a shorter path has few segments of 100 m, if any

/// The distance along the path from its first pose to each pose.
std::vector<double> waysAlong(const std::vector<SE3>& path) {
  std::vector<double> ways_m;
  ways_m.reserve(path.size());
  for (std::size_t i = 0; i < path.size(); ++i)
    ways_m.push_back(i == 0 ? 0 : ways_m.back() + (path[i].translation() - path[i - 1].translation()).norm());
  return ways_m;
}

/// One segment's share of the sums.
void addSegment(SegmentMeans& sums, const SE3& error, double length_m) {
  constexpr double kPercent = 100;
  ++sums.segments;
  sums.translation_percent += kPercent * error.translation().norm() / length_m;
  sums.rotation_deg_per_m += angleOf_deg(error.rotation()) / length_m;
}

void divideByCount(SegmentMeans& sums) {
  const auto n = static_cast<double>(std::max<std::size_t>(1, sums.segments));
  sums.translation_percent /= n;
  sums.rotation_deg_per_m /= n;
}

}  // namespace

std::optional<SegmentErrors> segmentErrors(const std::vector<SE3>& estimate, const std::vector<SE3>& truth) {
  assert(estimate.size() == truth.size());
  if (truth.empty()) return std::nullopt;
  const std::vector<double> ways_m = waysAlong(truth);
  SegmentErrors errors;
  errors.short_segments = ways_m.back() < kLeastForLongSegments_m;
  for (std::size_t k = 0; k < SegmentErrors::kLengths; ++k) {
    SegmentErrors::OfLength& of_length = errors.by_length[k];
    of_length.length_m = (errors.short_segments ? 10.0 : 100.0) * static_cast<double>(k + 1);
    for (std::size_t first = 0; first < truth.size(); first += kFramesBetweenSegments) {
      const auto last = std::ranges::upper_bound(ways_m, ways_m[first] + of_length.length_m) - ways_m.begin();
      if (last == std::ssize(ways_m)) break;
      const SE3 error = stepError(estimate[first], estimate[last], truth[first], truth[last]);
      addSegment(of_length, error, of_length.length_m);
      addSegment(errors.all, error, of_length.length_m);
    }
    divideByCount(of_length);
  }
  divideByCount(errors.all);
  return errors.all.segments > 0 ? std::optional(errors) : std::nullopt;
}

}  // namespace motorcade
