#include "frontend/shape/lost_objects.hpp"

#include <algorithm>

namespace motorcade {

std::vector<ObjectEstimate> LostObjects::predictedIn(const FrameEstimate& online) const {
  std::vector<ObjectEstimate> predicted;
  if (online.head.segment != segment_) return predicted;
  for (const auto& [track, seen] : last_seen_) {
    if (std::ranges::find(online.objects, track, &ObjectEstimate::track) != online.objects.end()) continue;
    ObjectEstimate& object = predicted.emplace_back(seen.object);
    const Eigen::Vector3d traveled_m = secondsBetween(seen.stamp, online.head.stamp) * object.velocity_world_mps;
    object.T_world_body = SE3(object.T_world_body.rotation(), object.T_world_body.translation() + traveled_m);
  }
  return predicted;
}

void LostObjects::remember(const FrameEstimate& online) {
  constexpr double kLeastExistence = 0.9;  // of what others may be a part of
  if (online.head.segment != segment_) last_seen_.clear();
  segment_ = online.head.segment;
  for (const ObjectEstimate& object : online.objects)
    if (object.cuboid && object.existence_probability >= kLeastExistence)
      last_seen_.insert_or_assign(object.track, LastSeen{online.head.frame, online.head.stamp, object});
  std::erase_if(last_seen_,
                [&](const auto& seen) { return online.head.frame.value - seen.second.frame.value > kMost; });
}

}  // namespace motorcade
