#include "backend/joint/landmarks_at_rest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace motorcade {
namespace {

constexpr double kKnownShare = 0.5;  // of the landmarks seen now, to which the camera can be aligned

LandmarkBundles::Params bundleParams(const JointParams& params, const StereoCamera& camera) {
  const int step = params.frames_per_elimination;
  return {.pose = FramePose::kWorldCam,
          .noise = params.static_noise,
          .points = pointParams(params, camera, params.track_frames, params.max_static_landmarks),
          .newest = IncrementalSolver::Lifetime::kLasting,
          .closing_frames = (params.frames_per_factor + step - 1) / step * step,
          .from_estimates = true};
}

}  // namespace

PoseVariable camerasOf(const LandmarksAtRest::Frames& frames) {
  return [&frames](FrameId frame) {
    const auto camera = frames.find(frame);
    return camera == frames.end() ? VariableId{} : camera->second.x;
  };
}

LandmarksAtRest::LandmarksAtRest(const JointParams& params, const StereoCamera& camera, IncrementalSolver& solver,
                                 const RigOffset& offset, RigShake& shake)
    : params_(params),
      camera_(camera),
      solver_(solver),
      offset_(offset),
      shake_(shake),
      bundles_(bundleParams(params, camera), NoiseLevel{}, camera, solver, offset, shake) {}

int LandmarksAtRest::seenAgain() {
  return static_cast<int>(
      std::ranges::count_if(bundles_.points().seenNow(), [](auto* track) { return track->views.size() >= 2; }));
}

void LandmarksAtRest::add(std::int64_t frame_count, const Frames& frames, FrameId leaving) {
  const bool due = frame_count % params_.frames_per_elimination == 0 || frames.rbegin()->second.weak;
  if (!due && bundles_.hasNewest())
    if (const auto alignment = alignNewest(frames)) return alignments_.push_back(*alignment);
  eliminate(frame_count, frames, leaving);
}

bool LandmarksAtRest::eliminateAligned(std::int64_t frame_count, const Frames& frames) {
  if (alignments_.empty()) return false;
  eliminate(frame_count, frames);
  return true;
}

void LandmarksAtRest::eliminate(std::int64_t frame_count, const Frames& frames, FrameId leaving) {
  for (const FactorId alignment : alignments_) solver_.removeFactor(alignment);
  alignments_.clear();
  bundles_.renew(frame_count, camerasOf(frames), leaving);
}

void LandmarksAtRest::relinearize(const Frames& frames) { bundles_.relinearize(camerasOf(frames)); }

/// Aligns the newest camera; empty when too few landmarks are known.
std::optional<FactorId> LandmarksAtRest::alignNewest(const Frames& frames) {
  const std::vector<LandmarkTrack*> tracks = bundles_.points().seenNow();
  if (tracks.empty()) return std::nullopt;
  const auto& [frame_before, before] = *std::next(frames.rbegin());
  const FrameIndex index(tracks, camerasOf(frames));
  std::vector<SE3> T_cam_world;
  for (const VariableId x : index.variables()) T_cam_world.push_back(solver_.pose(x).inverse());
  const std::vector<ViewOfKnown> views = knownViews(tracks, index, T_cam_world, frame_before);
  if (static_cast<double>(views.size()) < kKnownShare * static_cast<double>(tracks.size())) return std::nullopt;
  std::vector<VariableId> poses{before.x, frames.rbegin()->second.x};
  const std::array both{solver_.pose(poses[0]).inverse(), T_cam_world.back()};
  LandmarkNoise noise = params_.static_noise;
  noise.shake_sigma_px = shake_.sigma_px();
  EliminatedLandmarks known = alignToKnown(camera_, noise, views, both, offset_.px());
  if (!known.shakes.empty()) shake_.observe(std::array{frames.rbegin()->first}, std::span(known.shakes).last(1));
  return solver_.addFactor(std::make_unique<BundleFactor>(std::move(poses), offset_.variable(), std::move(known)));
}

/// Views in the newest frame of landmarks that the frame before saw; they are fitted to their earlier views at the
/// present poses.
std::vector<ViewOfKnown> LandmarksAtRest::knownViews(std::span<LandmarkTrack* const> tracks, const FrameIndex& index,
                                                     std::span<const SE3> T_cam_world, FrameId before) {
  LandmarkFit fit(camera_, params_.static_noise, FramePose::kWorldCam, T_cam_world, offset_.px());
  const std::vector<double> shakes_px = shake_.px(index.frames());
  std::vector<LandmarkView> earlier, newest;
  std::vector<ViewOfKnown> views;
  for (LandmarkTrack* track : tracks) {
    earlier.clear();
    index.append(std::span(track->views).first(track->views.size() - 1), noise(), earlier);
    for (LandmarkView& view : earlier) view.uvd_px.z() += shakes_px[view.frame];
    if (earlier.empty() || index.frames()[earlier.back().frame] != before) continue;
    if (!fit(earlier, track->estimate)) continue;
    track->estimate = fit.estimate();
    const auto known = fit.known();
    newest.clear();
    index.append(std::span(track->views).last(1), noise(), newest);
    const double sigmas = std::sqrt(fit.variance());
    if (known) views.push_back({*known, newest.back().uvd_px, newest.back().inverse_sigma / sigmas});
  }
  return views;
}

}  // namespace motorcade
