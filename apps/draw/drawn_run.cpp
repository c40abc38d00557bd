#include "apps/draw/drawn_run.hpp"

#include <algorithm>
#include <utility>

namespace motorcade {

std::vector<ObjectEstimate> DrawnRun::objectsAt(std::size_t frame) const {
  const auto found = objects.find(static_cast<std::int64_t>(frame));
  return found == objects.end() ? std::vector<ObjectEstimate>() : found->second;
}

std::vector<ObjectPoint> DrawnRun::pointsAt(std::size_t frame) const {
  const auto found = points.find(static_cast<std::int64_t>(frame));
  return found == points.end() ? std::vector<ObjectPoint>() : found->second;
}

std::vector<Eigen::Vector3d> DrawnRun::wayOf(TrackId track, const Eigen::Vector3d& p_body, std::size_t earliest,
                                             std::size_t frame) const {
  std::vector<Eigen::Vector3d> way;
  for (auto at = objects.lower_bound(static_cast<std::int64_t>(earliest)); at != objects.end(); ++at) {
    if (std::cmp_greater(at->first, frame)) break;
    for (const auto& object : at->second)
      if (object.track == track) way.push_back(object.T_world_body * p_body);
  }
  return way;
}

Color lightened(Color color) { return {(color.red + 255) / 2, (color.green + 255) / 2, (color.blue + 255) / 2}; }

Color trackColor(TrackId track) {
  constexpr std::array<Color, 10> kColors{{{255, 176, 32},
                                           {64, 196, 255},
                                           {124, 220, 92},
                                           {255, 105, 140},
                                           {186, 138, 255},
                                           {255, 224, 82},
                                           {64, 224, 190},
                                           {255, 138, 80},
                                           {140, 170, 255},
                                           {230, 130, 230}}};
  return kColors[std::max<std::int64_t>(track.value, 0) % kColors.size()];
}

}  // namespace motorcade
