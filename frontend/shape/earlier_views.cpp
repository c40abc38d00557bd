#include "frontend/shape/earlier_views.hpp"

#include <algorithm>

namespace motorcade {

void EarlierViews::move(const SE3& T_previous_now) {
  for (Frame& frame : frames_) frame.T_then_now = frame.T_then_now * T_previous_now;
}

void EarlierViews::add(const Features& features) {
  if (features.left.levels.empty()) return;
  Frame& added = frames_.emplace_back(Frame{features.frame->head.frame, features.left, SE3{}});
  added.left.levels.front() = Image{};
  if (frames_.size() > kMost) frames_.pop_front();
  const FrameId oldest = frames_.front().frame;
  for (auto& [track, places] : places_) places.erase(places.begin(), places.lower_bound(oldest));
  std::erase_if(places_, [](const auto& of_track) { return of_track.second.empty(); });
}

void EarlierViews::addPlace(TrackId track, FrameId frame, const SE3& T_cam_body) {
  places_[track].insert_or_assign(frame, T_cam_body);
}

const SE3* EarlierViews::place(TrackId track, FrameId frame) const {
  const auto places = places_.find(track);
  if (places == places_.end()) return nullptr;
  const auto place = places->second.find(frame);
  return place != places->second.end() ? &place->second : nullptr;
}

std::optional<ObjectView::Before> EarlierViews::last(TrackId track, const ObjectView& view, const Features& now) const {
  return frames_.empty() ? std::nullopt : viewIn(frames_.back(), track, view, now);
}

std::optional<ObjectView::Before> EarlierViews::wellApart(TrackId track, const ObjectView& view,
                                                          const Features& now) const {
  std::optional<ObjectView::Before> farthest;
  for (std::size_t then = frames_.size(); then-- > 0;) {
    const auto before = viewIn(frames_[then], track, view, now);
    if (before && (!farthest || before->apart > farthest->apart)) farthest = before;
    if (farthest && farthest->apart > std::max(ObjectView::kWellApart, view.width)) break;
  }
  return farthest;
}

std::optional<ObjectView::Before> EarlierViews::viewIn(const Frame& then, TrackId track, const ObjectView& view,
                                                       const Features& now) const {
  const SE3* T_then_body = place(track, then.frame);
  if (!T_then_body) return std::nullopt;
  const auto moved = camera_.project(T_then_body->translation()),
             rested = camera_.project(then.T_then_now * view.T_cam_body.translation());
  const double apart = moved && rested ? (moved->head<2>() - rested->head<2>()).norm() / (1 << view.level) : 0;
  return ObjectView::Before{&now.left, &then.left, *T_then_body, then.T_then_now, then.frame, apart};
}

}  // namespace motorcade
