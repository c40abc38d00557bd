#include "backend/joint/undecided_points.hpp"

namespace motorcade {

void UndecidedPoints::observe(FrameId frame, std::span<const PointMeasurement> points) {
  for (const PointMeasurement& p : points) {
    auto& views = views_[p.point];
    views.push_back({frame, p.uvd_px, p.sigma_px});
    if (static_cast<int>(views.size()) > most_views_) views.pop_front();
  }
  std::erase_if(views_, [&](const auto& point) { return isLost(point.second.back(), frame); });
}

std::vector<LandmarkTrack::View> UndecidedPoints::take(PointId point, FrameId frame, int most) {
  const auto known = views_.find(point);
  if (known == views_.end()) return {};
  std::vector<LandmarkTrack::View> views(known->second.begin(), known->second.end());
  views_.erase(known);
  std::erase_if(views, [&](const LandmarkTrack::View& view) { return view.frame >= frame; });
  if (static_cast<int>(views.size()) > most) views.clear();
  return views;
}

}  // namespace motorcade
