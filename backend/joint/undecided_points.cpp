#include "backend/joint/undecided_points.hpp"

#include <algorithm>
#include <utility>

#include "backend/joint/merge_by_point.hpp"

namespace motorcade {

void UndecidedPoints::Known::add(const LandmarkTrack::View& view) {
  if (count == kMostViews) {
    std::move(views.begin() + 1, views.end(), views.begin());
    --count;
  }
  views[count++] = view;
}

void UndecidedPoints::observe(FrameId frame, std::span<const PointMeasurement> points) {
  merged_.clear();
  life_.add(frame);
  const auto keep = [&](const Known& known) {
    if (known.count > 0 && !life_.isLost(known.all().back())) merged_.push_back(known);
  };
  const auto add = [&](const PointMeasurement& p, const Known* known) {
    Known& now = known ? merged_.emplace_back(*known) : merged_.emplace_back();
    now.point = p.point;
    now.add({frame, p.uvd_px, p.sigma_px});
  };
  mergeByPoint(
      known_, points, [](const Known& known) { return known.point; }, add, keep);
  std::swap(known_, merged_);
}

std::vector<LandmarkTrack::View> UndecidedPoints::take(PointId point, FrameId frame, int most) {
  const auto known = std::ranges::lower_bound(known_, point, {}, &Known::point);
  if (known == known_.end() || known->point != point) return {};
  std::vector<LandmarkTrack::View> views;
  for (const LandmarkTrack::View& view : known->all())
    if (view.frame < frame) views.push_back(view);
  known->count = 0;
  if (static_cast<int>(views.size()) > most) views.clear();
  return views;
}

}  // namespace motorcade
