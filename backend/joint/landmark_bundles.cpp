#include "backend/joint/landmark_bundles.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace motorcade {
namespace {

std::vector<LandmarkTrack*> pointersTo(std::vector<LandmarkTrack>& tracks) {
  std::vector<LandmarkTrack*> pointers;
  for (LandmarkTrack& track : tracks) pointers.push_back(&track);
  return pointers;
}

}  // namespace

LandmarkBundles::LandmarkBundles(const Params& params, const NoiseLevel& noise, const StereoCamera& camera,
                                 IncrementalSolver& solver, const RigOffset& offset)
    : params_(params), camera_(camera), solver_(solver), offset_(offset), points_(params.points), noise_(noise) {}

void LandmarkBundles::renew(std::int64_t frame_count, const PoseVariable& pose_variable) {
  if (newest_) solver_.removeFactor(newest_->factor);
  newest_.reset();
  std::ranges::move(points_.takeEnded(), std::back_inserter(ended_));
  if (frame_count % params_.closing_frames == 0) closeEnded(pose_variable);
  std::vector<LandmarkTrack*> tracks = points_.current();
  std::ranges::copy(pointersTo(ended_), std::back_inserter(tracks));
  newest_ = addBundle(tracks, pose_variable, params_.newest);
}

/// Tracks that ended become a factor for good.
void LandmarkBundles::closeEnded(const PoseVariable& pose_variable) {
  if (const auto bundle = addBundle(pointersTo(ended_), pose_variable, IncrementalSolver::Lifetime::kLasting)) {
    noise_.learn(bundle->levels);
    closed_.push_back({bundle->factor, bundle->first, std::move(ended_)});
  }
  ended_.clear();
}

/// The result is empty when no landmark has two views from poses that the graph holds.
std::optional<LandmarkBundles::Bundle> LandmarkBundles::addBundle(std::span<LandmarkTrack* const> tracks,
                                                                  const PoseVariable& pose_variable,
                                                                  IncrementalSolver::Lifetime lifetime) {
  if (tracks.empty()) return std::nullopt;
  const FrameIndex index(tracks, pose_variable);
  LandmarkViews landmarks;
  std::vector<LandmarkTrack*> landmark_tracks;
  for (LandmarkTrack* track : tracks) {
    const std::size_t first = landmarks.views.size();
    index.append(track->views, noise_, landmarks.views);
    if (landmarks.views.size() < first + 2) {
      landmarks.views.resize(first);
      continue;
    }
    landmarks.first_view.push_back(static_cast<int>(landmarks.views.size()));
    if (params_.from_estimates) landmarks.before.push_back(track->estimate);
    landmark_tracks.push_back(track);
  }
  if (landmarks.count() == 0) return std::nullopt;
  EliminatedLandmarks eliminated = eliminate(landmarks, index);
  const auto estimates = std::exchange(eliminated.estimates, {});  // which the factor does not need
  for (std::size_t i = 0; i < landmark_tracks.size(); ++i) landmark_tracks[i]->estimate = estimates[i];
  const ResidualLevels levels = eliminated.levels;
  const auto factor = solver_.addFactor(
      std::make_unique<BundleFactor>(index.variables(), offset_.variable(), std::move(eliminated)), lifetime);
  if (!factor) return std::nullopt;
  return Bundle{*factor, index.frames().front(), levels};
}

EliminatedLandmarks LandmarkBundles::eliminate(const LandmarkViews& landmarks, const FrameIndex& index) const {
  std::vector<SE3> T_cam_body;
  for (const VariableId v : index.variables()) {
    const SE3 pose = solver_.pose(v);
    T_cam_body.push_back(params_.pose == FramePose::kCamBody ? pose : pose.inverse());
  }
  return eliminateLandmarks(camera_, params_.noise, landmarks, params_.pose, std::move(T_cam_body), offset_.px());
}

void LandmarkBundles::relinearize(const PoseVariable& pose_variable) {
  for (Closed& closed : closed_) {
    solver_.removeFactor(closed.factor);
    if (const auto bundle = addBundle(pointersTo(closed.tracks), pose_variable, IncrementalSolver::Lifetime::kLasting))
      closed.factor = bundle->factor;
  }
}

void LandmarkBundles::retire(FrameId oldest) {
  std::erase_if(closed_, [oldest](const Closed& closed) { return closed.first <= oldest; });
  if (!newest_ || newest_->first > oldest) return;
  solver_.removeFactor(newest_->factor);
  newest_.reset();
}

void LandmarkBundles::drop() {
  newest_.reset();
  closed_.clear();
}

}  // namespace motorcade
