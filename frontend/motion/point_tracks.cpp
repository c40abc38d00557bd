#include "frontend/motion/point_tracks.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include "frontend/matching/ambiguous_texture.hpp"
#include "frontend/parallel_items.hpp"

namespace motorcade {
namespace {

/// Misfit per degree of freedom of a point at rest below which a track has the fitted position. The median of points at
/// rest is about 1, and a mover exceeds it within a few frames.
constexpr double kMaxStaticChi2 = 3.0;
/// Gain of motion over rest above which a track is checked for ambiguous texture: four standard deviations of a single
/// residual. Below it the motion is not significant anyway.
constexpr double kMinMotionChi2 = 16;
constexpr int kMaxAmbiguity = 3;  // frames after which an ambiguous point is trusted again when it no longer is
/// Observations from which on a track that is not ambiguous is checked in one of a few frames only, each in another
/// one.
constexpr int kTrusted_observations = 5;
constexpr std::int64_t kTrustedPeriod_frames = 4;

/// Tracks of a frame exceed the second cache, so a track is prefetched while those before it are at work.
constexpr std::size_t kPrefetchAhead = 3;
constexpr std::ptrdiff_t kPointsAhead = 8;  // where it is but the number of its point

void prefetchObservations(const PointTrack& track) {
  constexpr int kPerCacheLine = 64 / sizeof(PointObservation);
  for (int i = 0; i < track.count; i += kPerCacheLine) __builtin_prefetch(&track.observations[i]);
  __builtin_prefetch(&track.newest());
}

void prefetchPosition(const PointTrack& track) {
  __builtin_prefetch(&track.newest());
  __builtin_prefetch(&track.p_static_cam);
  __builtin_prefetch(&track.static_covariance(1, 1));
}

}  // namespace

PointTracks::PointTracks(const Params& params, const StereoCamera& camera)
    : params_(requireValid(params)), camera_(camera), scene_flow_(params.scene_flow, camera) {}

/// Index of the track of each flow observation, -1 for a new point. Both are ordered by point.
std::vector<int> PointTracks::tracksOf(const OpticalFlow& flow) const {
  std::vector<int> tracks;
  tracks.reserve(flow.observations.size());
  auto track = tracks_.begin();
  for (const auto& observation : flow.observations) {
    while (track != tracks_.end() && track->point < observation.point) {
      ++track;
      if (tracks_.end() - track > kPointsAhead) __builtin_prefetch(&track[kPointsAhead].point);
    }
    const bool found = track != tracks_.end() && track->point == observation.point;
    tracks.push_back(found ? static_cast<int>(track - tracks_.begin()) : -1);
  }
  return tracks;
}

std::vector<std::optional<KnownPoint>> PointTracks::known(const OpticalFlow& flow, const CameraTrail& trail) const {
  const auto tracks = tracksOf(flow);
  std::vector<std::optional<KnownPoint>> known(tracks.size());
  forEachItem(tracks.size(), [&](std::size_t i) {
    const std::size_t ahead = i + kPrefetchAhead;
    if (ahead < tracks.size() && tracks[ahead] >= 0) prefetchPosition(tracks_[tracks[ahead]]);
    if (tracks[i] >= 0) known[i] = knownPoint(tracks_[tracks[i]], trail);
  });
  return known;
}

/// Position of a point: the fitted one while the track fits a point at rest, else the triangulated one. Empty when the
/// trail no longer reaches back to the last observation.
std::optional<KnownPoint> PointTracks::knownPoint(const PointTrack& track, const CameraTrail& trail) const {
  const auto& newest = track.newest();
  const auto* relation = trail.find(newest.step);
  if (!relation) return std::nullopt;
  const SE3 T_last_then = relation->T_then_now.inverse();
  const Eigen::Vector3d uvd_px = newest.uvd_px.cast<double>();
  KnownPoint known{.p_cam = {}, .covariance = {}, .disparity_px = uvd_px.z(), .label = track.label};
  if (track.p_static_cam) {
    known.p_cam = T_last_then * *track.p_static_cam;
    known.covariance = T_last_then.rotation() * track.static_covariance * T_last_then.rotation().transpose();
    return known;
  }
  const Eigen::Matrix3d J = T_last_then.rotation() * camera_.triangulationJacobian(uvd_px);
  known.p_cam = T_last_then * camera_.triangulate(uvd_px);
  known.covariance = J * newest.sigma_px.cast<double>().cwiseAbs2().asDiagonal() * J.transpose();
  return known;
}

/// Flow observations whose points have a track now: those that were observed, in this frame or not long ago.
std::vector<std::size_t> PointTracks::keptPoints(std::span<const int> tracks,
                                                 const std::vector<std::optional<StereoObservation>>& observed) const {
  const std::int64_t oldest_kept = step_ - params_.max_missed_frames;
  std::vector<std::size_t> kept;
  kept.reserve(tracks.size());
  for (std::size_t i = 0; i < tracks.size(); ++i)
    if (observed[i] || (tracks[i] >= 0 && tracks_[tracks[i]].newest().step >= oldest_kept)) kept.push_back(i);
  return kept;
}

void PointTracks::update(const OpticalFlow& flow, const std::vector<std::optional<StereoObservation>>& observed,
                         const CameraTrail& trail) {
  const auto tracks = tracksOf(flow);
  step_ = trail.newest().step;
  const auto kept = keptPoints(tracks, observed);
  updated_.resize(kept.size());
  forEachItem(kept.size(), [&](std::size_t k) {
    if (k + kPrefetchAhead < kept.size())
      if (const int ahead = tracks[kept[k + kPrefetchAhead]]; ahead >= 0) prefetchObservations(tracks_[ahead]);
    const std::size_t i = kept[k];
    PointTrack& track = updated_[k];
    if (!observed[i]) {
      track = tracks_[tracks[i]];
      return;
    }
    const PointObservation observation{step_, observed[i]->uvd_px, observed[i]->sigma_px};
    if (tracks[i] >= 0) {
      track.extend(tracks_[tracks[i]], observation);
    } else {
      track.restart(flow.observations[i].point);
      track.add(observation);
    }
    fit(track, trail, *flow.features);
  });
  std::swap(tracks_, updated_);
  features_ = flow.features;
}

/// Fits the observations of a track up to now; nothing is known of its motion yet.
void PointTracks::fit(PointTrack& track, const CameraTrail& trail, const Features& now) const {
  if (track.count < 2) return;  // nothing to fit
  const auto [at_rest, moving] = scene_flow_.fit(track, trail);
  const double degrees_of_freedom = 3.0 * track.count - 3.0;
  if (at_rest && at_rest->chi2 < kMaxStaticChi2 * degrees_of_freedom) {
    track.p_static_cam = at_rest->p_cam;
    track.static_covariance = at_rest->covariance;
  }
  track.flow = moving;
  const bool trusted = track.ambiguity == 0 && track.count >= kTrusted_observations;
  if (trusted && (track.point.value + step_) % kTrustedPeriod_frames != 0) return;
  if (track.flow && track.flow->static_chi2 - track.flow->moving_chi2 > kMinMotionChi2)
    track.ambiguity = std::clamp(track.ambiguity + (isFoundAtRest(track, trail, now) ? 1 : -1), 0, kMaxAmbiguity);
}

/// True when its patch is also found where it would be at rest. It is looked for both ways, because something else may
/// hide its position at rest in one of the two images.
bool PointTracks::isFoundAtRest(const PointTrack& track, const CameraTrail& trail, const Features& now) const {
  const auto* before = track.find(step_ - 1);
  const auto* relation = trail.find(step_ - 1);
  if (!before || !relation) return false;
  const Image &left_now = now.left.levels.front(), &left_before = features_->left.levels.front();
  const Eigen::Vector3d uvd_now = track.newest().uvd_px.cast<double>(), uvd_before = before->uvd_px.cast<double>();
  const auto found = [&](const Eigen::Vector3d& uvd, const SE3& T_other_this, const FollowedPatch& patch) {
    const Eigen::Vector3d p = camera_.triangulate(uvd), p_other = T_other_this * p;
    const auto at_rest = camera_.project(p_other);
    return at_rest && isAlsoFoundAtRest(patch, at_rest->head<2>(), p.z() / p_other.z());
  };
  return found(uvd_now, relation->T_then_now, {left_now, left_before, uvd_now.head<2>(), uvd_before.head<2>()}) ||
         found(uvd_before, relation->T_then_now.inverse(),
               {left_before, left_now, uvd_before.head<2>(), uvd_now.head<2>()});
}

std::vector<std::reference_wrapper<const PointTrack>> PointTracks::observedNow() const {
  std::vector<std::reference_wrapper<const PointTrack>> observed;
  std::ranges::copy_if(tracks_, std::back_inserter(observed), [&](const PointTrack& t) { return isObservedNow(t); });
  return observed;
}

std::vector<RestingPoint> PointTracks::seenLast() const {
  std::vector<RestingPoint> points;
  for (const PointTrack& track : observedNow()) {
    if (track.label == PointLabel::kMoving) continue;
    const Eigen::Vector3d uvd_px = track.newest().uvd_px.cast<double>();
    points.push_back({.point = track.point,
                      .uvd_px = uvd_px,
                      .p_cam = track.p_static_cam ? *track.p_static_cam : camera_.triangulate(uvd_px),
                      .observations = track.count});
  }
  return points;
}

void PointTracks::setLabels(std::span<const ScenePoint> points) {
  auto point = points.begin();
  for (auto& track : tracks_)
    if (isObservedNow(track)) track.label = (point++)->label;
}

std::vector<StereoCorrespondence> PointTracks::atRestSince(std::int64_t step) const {
  std::vector<StereoCorrespondence> points;
  for (const PointTrack& track : observedNow()) {
    if (!track.p_static_cam || track.label == PointLabel::kMoving) continue;
    if (const auto* then = track.find(step)) points.push_back(track.sinceThen(*then));
  }
  return points;
}

void PointTracks::shiftDisparities(float change_px) {
  for (auto& track : tracks_)
    for (int i = 0; i < track.count; ++i) track.observations[i].uvd_px.z() += change_px;
}

std::vector<Parameter> parametersOf(PointTracks::Params& params) {
  return {numberParameter("max_missed_frames", params.max_missed_frames, {0, CameraTrail::kCapacity - 2},
                          "higher keeps points that are hidden for some frames")};
}

}  // namespace motorcade
