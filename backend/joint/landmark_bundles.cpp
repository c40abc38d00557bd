#include "backend/joint/landmark_bundles.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

#include "backend/joint/bundle_factor.hpp"
#include "backend/joint/residual_levels.hpp"

namespace motorcade {
namespace {

std::vector<LandmarkTrack*> pointersTo(std::vector<LandmarkTrack>& tracks) {
  std::vector<LandmarkTrack*> pointers;
  for (LandmarkTrack& track : tracks) pointers.push_back(&track);
  return pointers;
}

}  // namespace

LandmarkBundles::LandmarkBundles(const Params& params, const NoiseLevel& noise, const StereoCamera& camera,
                                 IncrementalSolver& solver, const RigOffset& offset, RigShake& shake)
    : params_(params),
      camera_(camera),
      solver_(solver),
      offset_(offset),
      shake_(shake),
      points_(params.points),
      noise_(noise) {}

void LandmarkBundles::renew(std::int64_t frame_count, const PoseVariable& pose_variable, FrameId leaving) {
  if (newest_) solver_.removeFactor(newest_->factor);
  newest_.reset();
  points_.endFrom(leaving);
  std::ranges::move(points_.takeEnded(), std::back_inserter(ended_));
  const auto leaves = [&](const LandmarkTrack& track) { return track.views.front().frame <= leaving; };
  if (frame_count % params_.closing_frames == 0 || std::ranges::any_of(ended_, leaves)) closeEnded(pose_variable);
  std::vector<LandmarkTrack*> tracks = points_.current();
  std::ranges::copy(pointersTo(ended_), std::back_inserter(tracks));
  if (tracks.empty()) return;
  const Gathered gathered = gather(tracks, pose_variable);
  newest_ = addBundle(gathered, params_.newest);
  if (!newest_) return;
  neighbors_per_view_ = neighborsPerView(camera_, gathered.landmarks);
  shake_.observe(newest_->frames, newest_->shakes);
}

/// Makes lasting factors of the tracks that ended.
void LandmarkBundles::closeEnded(const PoseVariable& pose_variable) {
  if (ended_.empty()) return;
  const Gathered gathered = gather(pointersTo(ended_), pose_variable);
  if (const auto bundle = addBundle(gathered, IncrementalSolver::Lifetime::kLasting)) {
    noise_.learn(residualLevels(camera_, params_.noise, gathered.landmarks, params_.pose,
                                posesFromCamera(gathered.index), offset_.px()));
    closed_.push_back({bundle->factor, bundle->frames.front(), std::move(ended_)});
  }
  ended_.clear();
}

LandmarkBundles::Gathered LandmarkBundles::gather(std::span<LandmarkTrack* const> tracks,
                                                  const PoseVariable& pose_variable) const {
  Gathered gathered{.index = FrameIndex(tracks, pose_variable), .landmarks = {}, .tracks = {}};
  LandmarkViews& landmarks = gathered.landmarks;
  for (LandmarkTrack* track : tracks) {
    const std::size_t first = landmarks.views.size();
    gathered.index.append(track->views, noise_, landmarks.views);
    if (landmarks.views.size() < first + 2) {
      landmarks.views.resize(first);
      continue;
    }
    landmarks.first_view.push_back(static_cast<int>(landmarks.views.size()));
    if (params_.from_estimates) landmarks.before.push_back(track->estimate);
    gathered.tracks.push_back(track);
  }
  landmarks.shakes_px = shake_.px(gathered.index.frames());
  for (LandmarkView& view : landmarks.views) view.uvd_px.z() += landmarks.shakes_px[view.frame];
  return gathered;
}

/// Adds a bundle; empty when there is no landmark.
std::optional<LandmarkBundles::Bundle> LandmarkBundles::addBundle(const Gathered& gathered,
                                                                  IncrementalSolver::Lifetime lifetime) {
  if (gathered.landmarks.count() == 0) return std::nullopt;
  LandmarkNoise noise = params_.noise;
  if (params_.tells_shake) noise.shake_sigma_px = shake_.sigma_px();
  EliminatedLandmarks eliminated = eliminateLandmarks(camera_, noise, gathered.landmarks, params_.pose,
                                                      posesFromCamera(gathered.index), offset_.px());
  const auto estimates = std::exchange(eliminated.estimates, {});  // which the factor does not need
  for (std::size_t i = 0; i < estimates.size(); ++i) gathered.tracks[i]->estimate = estimates[i];
  Bundle bundle{.factor = {}, .frames = gathered.index.frames(), .shakes = std::exchange(eliminated.shakes, {})};
  const auto factor = solver_.addFactor(
      std::make_unique<BundleFactor>(gathered.index.variables(), offset_.variable(), std::move(eliminated)), lifetime);
  if (!factor) return std::nullopt;
  bundle.factor = *factor;
  return bundle;
}

std::vector<SE3> LandmarkBundles::posesFromCamera(const FrameIndex& index) const {
  std::vector<SE3> T_cam_body;
  for (const VariableId v : index.variables()) {
    const SE3 pose = solver_.pose(v);
    T_cam_body.push_back(params_.pose == FramePose::kCamBody ? pose : pose.inverse());
  }
  return T_cam_body;
}

void LandmarkBundles::relinearize(const PoseVariable& pose_variable) {
  for (Closed& closed : closed_) {
    solver_.removeFactor(closed.factor);
    const Gathered gathered = gather(pointersTo(closed.tracks), pose_variable);
    if (const auto bundle = addBundle(gathered, IncrementalSolver::Lifetime::kLasting)) closed.factor = bundle->factor;
  }
}

void LandmarkBundles::retire(FrameId oldest) {
  assert(!newest_ || newest_->frames.front() > oldest);
  std::erase_if(closed_, [oldest](const Closed& closed) { return closed.first <= oldest; });
}

void LandmarkBundles::drop() {
  newest_.reset();
  closed_.clear();
}

}  // namespace motorcade
