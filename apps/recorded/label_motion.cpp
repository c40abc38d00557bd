#include "apps/recorded/label_motion.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

namespace motorcade {
namespace {

constexpr double kLeastWay_m = 1.5;     // labels of parked cars wander by up to 1.3 m, at most at .4 m/s
constexpr std::size_t kLeastSteps = 5;  // of a part of a track, among which a single jump does not count

Eigen::Vector3d wayBetween(const StampedPlace& from, const StampedPlace& to) { return to.p_world - from.p_world; }

/// True when a part of a track is long enough, fast enough, and more than a jump: no step exceeds its share of the time
/// by more than half of the way.
bool goesAway(std::span<const StampedPlace> part) {
  constexpr double kJump = 0.5;
  const Eigen::Vector3d way = wayBetween(part.front(), part.back());
  const double time_s = secondsBetween(part.front().stamp, part.back().stamp), way_m = way.norm();
  if (way_m <= kLeastWay_m || way_m <= kMovingSpeed_mps * time_s) return false;
  for (std::size_t i = 1; i < part.size(); ++i) {
    const double along_m = wayBetween(part[i - 1], part[i]).dot(way) / way_m;
    if (along_m / way_m >= kJump + secondsBetween(part[i - 1].stamp, part[i].stamp) / time_s) return false;
  }
  return true;
}

}  // namespace

bool travels(const std::vector<StampedPlace>& track) {
  const auto isAwayFrom = [&](const StampedPlace& from) {
    return [&](const StampedPlace& place) { return wayBetween(from, place).norm() > kLeastWay_m; };
  };
  if (track.empty() || std::ranges::none_of(track, isAwayFrom(track.front()))) return false;
  for (std::size_t from = 0; from + 1 < track.size(); ++from) {
    const auto away =
        std::find_if(track.begin() + static_cast<std::ptrdiff_t>(from), track.end(), isAwayFrom(track[from]));
    if (away == track.end()) continue;
    const std::size_t found = static_cast<std::size_t>(away - track.begin());
    const std::size_t to = std::min(std::max(found, from + kLeastSteps), track.size() - 1);
    const std::size_t begin = std::min(from, to - std::min(to, kLeastSteps));
    if (goesAway(std::span(track).subspan(begin, to - begin + 1))) return true;
  }
  return false;
}

std::set<std::int64_t> travelingLabels(const std::vector<ObjectTruth>& objects, const std::vector<Timestamp>& stamps) {
  std::map<std::int64_t, std::vector<StampedPlace>> tracks;
  for (const ObjectTruth& object : objects)
    if (std::cmp_less(object.frame.value, stamps.size()))
      tracks[object.id].push_back({stamps[object.frame.value], object.T_world_object.translation()});
  std::set<std::int64_t> traveling;
  for (const auto& [id, track] : tracks)
    if (travels(track)) traveling.insert(id);
  return traveling;
}

}  // namespace motorcade
