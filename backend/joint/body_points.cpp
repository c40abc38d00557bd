#include "backend/joint/body_points.hpp"

#include <algorithm>
#include <utility>

namespace motorcade {
namespace {

constexpr int kColumns = 8, kRows = 4;  // of the grid over the image in which landmarks are spread

}  // namespace

void TrackLife::add(FrameId frame) {
  frames_.push_back(frame);
  if (frames_.size() > kMaxGap_frames + 1) frames_.pop_front();
  oldest_ = frames_.front();
}

void BodyPoints::observe(FrameId frame, std::span<const PointMeasurement> points, const EarlierViews& earlier) {
  newest_ = frame;
  life_.add(frame);
  for (const PointMeasurement& p : points) {
    if (params_.half > 0 && p.point.value % 2 != params_.half % 2) continue;
    const auto [at, is_new] = candidates_.try_emplace(p.point);
    Candidate& candidate = at->second;
    LandmarkTrack& track = candidate.track;
    if (is_new) track.point = p.point;
    if (is_new && earlier) track.views = earlier(p.point);
    track.views.push_back({frame, p.uvd_px, p.sigma_px});
    if (static_cast<int>(track.views.size()) <= params_.max_views) continue;
    if (candidate.chosen) {
      const LandmarkTrack::View newest = track.views.back();
      track.views.pop_back();
      end(candidate);
      track.views = {newest};
    } else {
      track.views.erase(track.views.begin());
    }
  }
  for (auto it = candidates_.begin(); it != candidates_.end();) {
    const bool lost = life_.isLost(it->second.track.views.back());
    if (lost && it->second.chosen) end(it->second);
    it = lost ? candidates_.erase(it) : std::next(it);
  }
  choose();
}

void BodyPoints::end(Candidate& candidate) {
  if (candidate.track.views.size() >= 2) ended_.push_back(std::move(candidate.track));
  candidate.track.views.clear();
}

void BodyPoints::forget(std::span<const PointMeasurement> points) {
  for (const PointMeasurement& p : points) candidates_.erase(p.point);
}

int BodyPoints::cellOf(const Candidate& candidate) const {
  const Eigen::Vector3f& uvd_px = candidate.track.views.back().uvd_px;
  const int column = static_cast<int>(uvd_px.x()) * kColumns / std::max(params_.image_width_px, 1);
  const int row = static_cast<int>(uvd_px.y()) * kRows / std::max(params_.image_height_px, 1);
  return std::clamp(row, 0, kRows - 1) * kColumns + std::clamp(column, 0, kColumns - 1);
}

/// Fills up the landmarks: the longest tracks first, cell by cell of the image in turn.
void BodyPoints::choose() {
  if (candidates_.empty()) return;
  std::vector<std::vector<Candidate*>> cells(kColumns * kRows);
  std::vector<int> held(kColumns * kRows, 0);
  int left = params_.max_landmarks;
  for (auto& [point, candidate] : candidates_) {
    if (candidate.track.views.back().frame != newest_) continue;
    const int cell = cellOf(candidate);
    if (candidate.chosen)
      ++held[cell], --left;
    else if (candidate.track.views.size() >= 2)
      cells[cell].push_back(&candidate);
  }
  for (auto& cell : cells)
    std::ranges::stable_sort(cell, std::greater{}, [](const Candidate* c) { return c->track.views.size(); });
  for (int level = 1; left > 0; ++level) {
    bool any = false;
    for (std::size_t c = 0; c < cells.size() && left > 0; ++c) {
      if (cells[c].empty()) continue;
      any = true;
      if (held[c] >= level) continue;
      cells[c].front()->chosen = true;
      cells[c].erase(cells[c].begin());
      ++held[c], --left;
    }
    if (!any) break;
  }
}

std::vector<LandmarkTrack> BodyPoints::takeEnded() { return std::exchange(ended_, {}); }

std::vector<LandmarkTrack*> BodyPoints::current() {
  std::vector<LandmarkTrack*> tracks;
  for (auto& [point, candidate] : candidates_)
    if (candidate.chosen && candidate.track.views.size() >= 2) tracks.push_back(&candidate.track);
  return tracks;
}

std::vector<LandmarkTrack*> BodyPoints::seenNow() {
  std::vector<LandmarkTrack*> tracks;
  for (auto& [point, candidate] : candidates_)
    if (candidate.chosen && candidate.track.views.back().frame == newest_) tracks.push_back(&candidate.track);
  return tracks;
}

}  // namespace motorcade
