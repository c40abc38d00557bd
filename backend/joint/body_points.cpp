#include "backend/joint/body_points.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "backend/joint/merge_by_point.hpp"

namespace motorcade {
namespace {

constexpr int kColumns = 8, kRows = 4;  // of the grid over the image in which landmarks are spread
/// Spacing of the newest frames that a cut leaves; it doubles where they are more than four times as old, and so on.
constexpr int kKeptSpacing_frames = 4;

}  // namespace

void TrackLife::add(FrameId frame) {
  frames_.push_back(frame);
  if (frames_.size() > kMaxGap_frames + 1) frames_.pop_front();
  oldest_ = frames_.front();
}

void BodyPoints::observe(FrameId frame, std::span<const PointMeasurement> points, const EarlierViews& earlier) {
  newest_ = frame;
  life_.add(frame);
  merged_.clear();
  const auto keep = [&](Candidate& known) {
    if (!life_.isLost(known.track.views.back()))
      merged_.push_back(std::move(known));
    else if (known.chosen)
      end(known);
  };
  const auto add = [&](const PointMeasurement& p, Candidate* known) {
    if (params_.half > 0 && p.point.value % 2 != params_.half % 2) return;
    Candidate& candidate = merged_.emplace_back(known ? std::move(*known) : Candidate{.track = {p.point, {}}});
    if (!known && earlier) candidate.track.views = earlier(p.point);
    extend(candidate, {frame, p.uvd_px, p.sigma_px});
  };
  mergeByPoint(
      candidates_, points, [](const Candidate& c) { return c.track.point; }, add, keep);
  std::swap(candidates_, merged_);
  choose();
}

void BodyPoints::extend(Candidate& candidate, const LandmarkTrack::View& view) {
  auto& views = candidate.track.views;
  if (static_cast<int>(views.size()) == params_.max_views) {
    if (candidate.chosen) cut(candidate);
    if (static_cast<int>(views.size()) == params_.max_views) views.erase(views.begin());
  }
  views.push_back(view);
}

void BodyPoints::cut(Candidate& candidate) {
  split(candidate, [this](const LandmarkTrack::View& view) { return isKept(view.frame); });
}

/// Gives the views that do not stay to a track that ended.
template <class Stays>
void BodyPoints::split(Candidate& candidate, const Stays& stays) {
  auto& views = candidate.track.views;
  const auto kept = std::stable_partition(views.begin(), views.end(), std::not_fn(stays));
  LandmarkTrack ended{candidate.track.point, {views.begin(), kept}, candidate.track.estimate};
  views.erase(views.begin(), kept);
  if (candidate.chosen && ended.views.size() >= 2) ended_.push_back(std::move(ended));
}

bool BodyPoints::isKept(FrameId frame) const {
  const std::int64_t age = newest_.value - frame.value;
  if (age > params_.oldest_kept_frames) return false;
  std::int64_t spacing = kKeptSpacing_frames;
  while (age > 4 * spacing) spacing *= 2;
  return frame.value % spacing == 0;
}

void BodyPoints::end(Candidate& candidate) {
  if (candidate.track.views.size() >= 2) ended_.push_back(std::move(candidate.track));
  candidate.track.views.clear();
}

/// The points take turns, so that the tracks that end link each frame to the leaving one.
void BodyPoints::endFrom(FrameId oldest) {
  const FrameId middle{(oldest.value + newest_.value) / 2};
  for (Candidate& candidate : candidates_) {
    if (candidate.track.views.front().frame > oldest) continue;
    const std::int64_t point = candidate.track.point.value;
    split(candidate,
          [&](const LandmarkTrack::View& view) { return view.frame > middle && (view.frame.value + point) % 2 == 0; });
  }
  std::erase_if(candidates_, [](const Candidate& candidate) { return candidate.track.views.empty(); });
}

void BodyPoints::forget(std::span<const PointMeasurement> points) {
  auto point = points.begin();
  std::erase_if(candidates_, [&](const Candidate& candidate) {
    while (point != points.end() && point->point < candidate.track.point) ++point;
    return point != points.end() && point->point == candidate.track.point;
  });
}

int BodyPoints::cellOf(const Candidate& candidate) const {
  const Eigen::Vector3f& uvd_px = candidate.track.views.back().uvd_px;
  const int column = static_cast<int>(uvd_px.x()) * kColumns / std::max(params_.image_width_px, 1);
  const int row = static_cast<int>(uvd_px.y()) * kRows / std::max(params_.image_height_px, 1);
  return std::clamp(row, 0, kRows - 1) * kColumns + std::clamp(column, 0, kColumns - 1);
}

/// Fills up the landmarks: the longest tracks first, in turn from the cells of the image.
void BodyPoints::choose() {
  struct Waiting {
    Candidate* candidate;
    int cell, turn = 0;  // turn of the cell, which takes one in each, from the number of those it holds on
  };
  std::vector<Waiting> waiting;
  std::array<int, kColumns * kRows> held{};
  int left = params_.max_landmarks;
  for (Candidate& candidate : candidates_) {
    if (candidate.track.views.back().frame != newest_) continue;
    if (candidate.chosen)
      ++held[cellOf(candidate)], --left;
    else if (candidate.track.views.size() >= 2)
      waiting.push_back({&candidate, cellOf(candidate)});
  }
  if (left <= 0) return;
  std::ranges::stable_sort(waiting, std::greater{}, [](const Waiting& w) { return w.candidate->track.views.size(); });
  for (Waiting& w : waiting) w.turn = held[w.cell]++;
  std::ranges::sort(waiting, {}, [](const Waiting& w) { return std::pair(w.turn, w.cell); });
  for (const Waiting& w : std::span(waiting).first(std::min<std::size_t>(waiting.size(), left)))
    w.candidate->chosen = true;
}

std::vector<LandmarkTrack> BodyPoints::takeEnded() { return std::exchange(ended_, {}); }

std::vector<LandmarkTrack*> BodyPoints::current() {
  std::vector<LandmarkTrack*> tracks;
  for (Candidate& candidate : candidates_)
    if (candidate.chosen && candidate.track.views.size() >= 2) tracks.push_back(&candidate.track);
  return tracks;
}

std::vector<LandmarkTrack*> BodyPoints::seenNow() {
  std::vector<LandmarkTrack*> tracks;
  for (Candidate& candidate : candidates_)
    if (candidate.chosen && candidate.track.views.back().frame == newest_) tracks.push_back(&candidate.track);
  return tracks;
}

}  // namespace motorcade
