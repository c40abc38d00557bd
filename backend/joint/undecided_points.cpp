#include "backend/joint/undecided_points.hpp"

#include <algorithm>
#include <utility>

#include "backend/joint/merge_by_point.hpp"

namespace motorcade {

void UndecidedPoints::observe(FrameId frame, std::span<const PointMeasurement> points) {
  merged_.clear();
  life_.add(frame);
  const auto keep = [&](LandmarkTrack& known) {
    if (!known.views.empty() && !life_.isLost(known.views.back())) merged_.push_back(std::move(known));
  };
  const auto add = [&](const PointMeasurement& p, LandmarkTrack* known) {
    LandmarkTrack& track = merged_.emplace_back(known ? std::move(*known) : LandmarkTrack{p.point, {}});
    if (static_cast<int>(track.views.size()) == most_views_) track.views.erase(track.views.begin());
    track.views.push_back({frame, p.uvd_px, p.sigma_px});
  };
  mergeByPoint(
      known_, points, [](const LandmarkTrack& track) { return track.point; }, add, keep);
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
