#include "backend/joint/undecided_points.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace motorcade {

void UndecidedPoints::observe(FrameId frame, std::span<const PointMeasurement> points) {
  merged_.clear();
  life_.add(frame);
  auto known = known_.begin();
  const auto keepUpTo = [&](PointId point) {
    for (; known != known_.end() && known->point < point; ++known)
      if (!known->views.empty() && !life_.isLost(known->views.back())) merged_.push_back(std::move(*known));
  };
  for (const PointMeasurement& p : points) {
    keepUpTo(p.point);
    const bool is_known = known != known_.end() && known->point == p.point;
    LandmarkTrack& track = merged_.emplace_back(is_known ? std::move(*known++) : LandmarkTrack{p.point, {}});
    if (static_cast<int>(track.views.size()) == most_views_) track.views.erase(track.views.begin());
    track.views.push_back({frame, p.uvd_px, p.sigma_px});
  }
  keepUpTo({std::numeric_limits<std::int64_t>::max()});
  std::swap(known_, merged_);
}

std::vector<LandmarkTrack::View> UndecidedPoints::take(PointId point, FrameId frame, int most) {
  const auto known = std::ranges::lower_bound(known_, point, {}, &LandmarkTrack::point);
  if (known == known_.end() || known->point != point) return {};
  std::vector<LandmarkTrack::View> views = std::exchange(known->views, {});
  std::erase_if(views, [&](const LandmarkTrack::View& view) { return view.frame >= frame; });
  if (static_cast<int>(views.size()) > most) views.clear();
  return views;
}

}  // namespace motorcade
