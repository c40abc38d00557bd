/// The part of JointGraph that turns points into factors, and finds the disparity offset by them.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "backend/joint/joint_graph.hpp"
#include "backend/joint/known_landmarks.hpp"

namespace motorcade {
namespace {

constexpr double kHeldSigma_px = 1e-5;    // of a held offset: very long drives do not move it either
constexpr double kClearSigma_px = 0.1;    // of an observed offset, from which on it is looked at
constexpr double kDistortion_px = 0.5;    // what looks like an offset up to here may be distortion
constexpr double kOffsetStep_px = 0.1;    // of the offset, after which landmarks are eliminated anew
constexpr int kFirstLook_frames = 8;      // after which the offset is looked at
constexpr int kCalibration_frames = 100;  // of the drive, in which the offset may be found
constexpr int kFramesPerFactor = 5;       // tracks that ended in so many frames share one
constexpr double kKnownShare = 0.5;       // of the landmarks seen now, to which the camera can be aligned

std::vector<LandmarkTrack*> pointersTo(std::vector<LandmarkTrack>& tracks) {
  std::vector<LandmarkTrack*> pointers;
  for (LandmarkTrack& track : tracks) pointers.push_back(&track);
  return pointers;
}

/// The frames of tracks, which are few and near each other, as far as the graph holds them.
class FrameIndex {
 public:
  FrameIndex(const std::vector<LandmarkTrack*>& tracks, const std::function<bool(FrameId)>& in_graph)
      : first_(tracks.front()->views.front().frame) {
    FrameId last = first_;
    for (const LandmarkTrack* track : tracks) {
      first_ = std::min(first_, track->views.front().frame);
      last = std::max(last, track->views.back().frame);
    }
    of_.assign(last.value - first_.value + 1, kNone);
    for (const LandmarkTrack* track : tracks)
      for (const auto& view : track->views) of_[view.frame.value - first_.value] = kSeen;
    for (int i = 0; i < static_cast<int>(of_.size()); ++i) {
      const FrameId frame{first_.value + i};
      if (of_[i] == kNone || !in_graph(frame)) {
        of_[i] = kNone;
      } else {
        of_[i] = static_cast<int>(frames_.size());
        frames_.push_back(frame);
      }
    }
  }

  const std::vector<FrameId>& frames() const { return frames_; }
  /// The place of a track's frame among `frames`, negative when the graph does not hold it.
  int of(FrameId frame) const { return of_[frame.value - first_.value]; }

 private:
  static constexpr int kNone = -1, kSeen = 0;

  FrameId first_;
  std::vector<FrameId> frames_;
  std::vector<int> of_;
};

/// Appends the views that are in the graph.
void appendViews(std::span<const LandmarkTrack::View> views, const FrameIndex& index, const NoiseLevel& noise,
                 std::vector<LandmarkView>& to) {
  const Eigen::Vector3d level = noise.sigmas();
  for (const auto& view : views)
    if (const int frame = index.of(view.frame); frame >= 0)
      to.push_back(
          {frame, view.uvd_px.cast<double>(), level.cwiseProduct(view.sigma_px.cast<double>()).cwiseInverse()});
}

}  // namespace

/// Landmarks at rest are many: they are eliminated in one of some frames. In the others they stay where they were found
/// to be, and the newest camera is aligned to them, until the next elimination takes that back.
void JointGraph::addPointsAtRest() {
  const bool due = (added_frames_ - 1) % params_.frames_per_elimination == 0 || frames_.rbegin()->second.weak;
  if (!due && world_.current)
    if (const auto alignment = alignNewest()) return alignments_.push_back(*alignment);
  eliminateAtRest();
}

void JointGraph::eliminateAtRest() {
  for (const FactorId alignment : alignments_) solver_.removeFactor(alignment);
  alignments_.clear();
  addPoints(world_, nullptr);
}

/// The landmarks are fitted to their earlier views, where the poses are now. Empty where too few are known.
std::optional<FactorId> JointGraph::alignNewest() {
  const std::vector<LandmarkTrack*> tracks = world_.points.seenNow();
  if (tracks.empty()) return std::nullopt;
  const auto& [frame_before, before] = *std::next(frames_.rbegin());
  const FrameIndex index(tracks, [&](FrameId frame) { return frames_.contains(frame); });
  std::vector<SE3> T_cam_body;
  for (const FrameId frame : index.frames()) T_cam_body.push_back(solver_.pose(frames_.at(frame).x).inverse());
  LandmarkFit fit(camera_, params_.static_noise, FramePose::kWorldCam, T_cam_body, offset_px());
  std::vector<LandmarkView> earlier;
  std::vector<ViewOfKnown> views;
  for (LandmarkTrack* track : tracks) {
    earlier.clear();
    appendViews(std::span(track->views).first(track->views.size() - 1), index, world_.noise, earlier);
    if (earlier.empty() || index.frames()[earlier.back().frame] != frame_before) continue;
    if (!fit(earlier, track->estimate)) continue;
    track->estimate = fit.estimate();
    const auto known = fit.known();
    earlier.clear();
    appendViews(std::span(track->views).last(1), index, world_.noise, earlier);
    if (known) views.push_back({*known, earlier.back().uvd_px, earlier.back().inverse_sigma});
  }
  if (static_cast<double>(views.size()) < kKnownShare * static_cast<double>(tracks.size())) return std::nullopt;
  std::vector<VariableId> poses{before.x, frames_.rbegin()->second.x};
  const std::array T_cam_world{solver_.pose(poses[0]).inverse(), T_cam_body.back()};
  return solver_.addFactor(std::make_unique<BundleFactor>(
      std::move(poses), offset_, alignToKnown(camera_, params_.static_noise, views, T_cam_world, offset_px())));
}

/// The factor over the tracks that go on, and over those that ended lately, is made anew.
void JointGraph::addPoints(JointPoints& body, const JointObject* object) {
  if (body.current) solver_.removeFactor(*body.current);
  body.current.reset();
  std::ranges::move(body.points.takeEnded(), std::back_inserter(body.ended));
  if (object && !object->travel.valid()) return body.ended.clear();
  if (closesNow(object)) closeEnded(body, object);
  std::vector<LandmarkTrack*> tracks = body.points.current();
  std::ranges::copy(pointersTo(body.ended), std::back_inserter(tracks));
  using Lifetime = IncrementalSolver::Lifetime;
  body.current = addBundle(tracks, body.noise, object, object ? Lifetime::kProvisional : Lifetime::kLasting);
}

/// At rest, in a frame in which landmarks are eliminated in any case.
bool JointGraph::closesNow(const JointObject* object) const {
  const int step = object ? 1 : params_.frames_per_elimination;
  return (added_frames_ - 1) % ((kFramesPerFactor + step - 1) / step * step) == 0;
}

/// Tracks that ended become a factor for good.
void JointGraph::closeEnded(JointPoints& body, const JointObject* object) {
  if (const auto id = addBundle(pointersTo(body.ended), body.noise, object)) {
    const auto& factor = dynamic_cast<const BundleFactor&>(solver_.graph().factor(*id));
    body.noise.learn(factor.landmarks().levels);
    FrameId first = body.ended.front().views.front().frame;
    for (const LandmarkTrack& track : body.ended) first = std::min(first, track.views.front().frame);
    body.closed.push_back({*id, first, std::move(body.ended)});
  }
  body.ended.clear();
}

std::optional<FactorId> JointGraph::addBundle(const std::vector<LandmarkTrack*>& tracks, const NoiseLevel& noise,
                                              const JointObject* object, IncrementalSolver::Lifetime lifetime) {
  if (tracks.empty()) return std::nullopt;
  const FrameIndex index(tracks, [&](FrameId frame) {
    if (!frames_.contains(frame)) return false;
    const auto record = object ? object->records.find(frame) : decltype(object->records.begin()){};
    return !object || (record != object->records.end() && record->second.c.valid());
  });
  LandmarkViews landmarks;
  std::vector<LandmarkTrack*> landmark_tracks;
  for (LandmarkTrack* track : tracks) {
    const std::size_t first = landmarks.views.size();
    appendViews(track->views, index, noise, landmarks.views);
    if (landmarks.views.size() < first + 2) {
      landmarks.views.resize(first);
      continue;
    }
    landmarks.first_view.push_back(static_cast<int>(landmarks.views.size()));
    if (!object) landmarks.before.push_back(track->estimate);  // a vehicle's points may slide: from the newest view
    landmark_tracks.push_back(track);
  }
  if (landmarks.count() == 0) return std::nullopt;
  std::vector<VariableId> poses;
  std::vector<SE3> T_cam_body;
  for (const FrameId frame : index.frames()) {
    poses.push_back(object ? object->records.at(frame).c : frames_.at(frame).x);
    T_cam_body.push_back(object ? solver_.pose(poses.back()) : solver_.pose(poses.back()).inverse());
  }
  EliminatedLandmarks eliminated =
      eliminateLandmarks(camera_, object ? params_.object_noise : params_.static_noise, landmarks,
                         object ? FramePose::kCamBody : FramePose::kWorldCam, std::move(T_cam_body), offset_px());
  const auto estimates = std::exchange(eliminated.estimates, {});  // which the factor does not need
  for (std::size_t i = 0; i < landmark_tracks.size(); ++i) landmark_tracks[i]->estimate = estimates[i];
  return solver_.addFactor(std::make_unique<BundleFactor>(std::move(poses), offset_, std::move(eliminated)), lifetime);
}

void JointGraph::holdOffset() { setOffsetPrior(kHeldSigma_px); }

void JointGraph::setOffsetPrior(double sigma_px) {
  if (offset_prior_) solver_.removeFactor(*offset_prior_);
  offset_prior_ = solver_.addFactor(std::make_unique<VectorPriorFactor>(
      offset_, SmallVector(SmallVector::Zero(1)), SmallVector(SmallVector::Constant(1, sigma_px))));
}

/// What the landmarks alone say of the offset: the posterior without its prior.
std::optional<double> JointGraph::observedOffset_px() const {
  const auto covariance = solver_.jointCovariance(std::span(&offset_, 1));
  if (!covariance) return std::nullopt;
  const double posterior = 1 / (*covariance)(0, 0), observed = posterior - 1 / (kHeldSigma_px * kHeldSigma_px);
  if (observed < 1 / (kClearSigma_px * kClearSigma_px)) return std::nullopt;
  return offset_px() * posterior / observed;
}

/// A rig is taken as calibrated until the landmarks of its first frames clearly say that it is not; only then does its
/// offset move. Lens distortions alone look like an offset of 0.2 to 0.4 px on real rigs (it depends on where in the
/// image the points are), and correcting that makes paths worse.
void JointGraph::calibrate() {
  if (params_.offset_sigma_px <= 0) return;
  const std::int64_t age = frames_.rbegin()->first.value - first_frame_.value;
  if (!offset_free_ && age >= kFirstLook_frames && age <= kCalibration_frames) {
    const auto observed_px = observedOffset_px();
    if (observed_px && std::abs(*observed_px) > kDistortion_px) {
      offset_free_ = true;
      setOffsetPrior(params_.offset_sigma_px);
      dropTroubled(solver_.update());
    }
  }
  if (std::abs(offset_px() - linearized_offset_px_) > kOffsetStep_px) linearizeLandmarksAnew();
  if (age > kCalibration_frames) forgetClosed([](const ClosedTracks&) { return true; });
}

/// Landmarks were eliminated at another offset.
void JointGraph::linearizeLandmarksAnew() {
  linearized_offset_px_ = offset_px();
  relinearizeClosed(world_, nullptr);
  for (auto& [id, object] : objects_)
    if (object.travel.valid()) relinearizeClosed(object.points, &object);
  dropTroubled(solver_.update());
}

void JointGraph::relinearizeClosed(JointPoints& body, const JointObject* object) {
  for (ClosedTracks& closed : body.closed) {
    solver_.removeFactor(closed.factor);
    if (const auto id = addBundle(pointersTo(closed.tracks), body.noise, object)) closed.factor = *id;
  }
}

void JointGraph::forgetClosed(const std::function<bool(const ClosedTracks&)>& forgotten) {
  std::erase_if(world_.closed, forgotten);
  for (auto& [id, object] : objects_) std::erase_if(object.points.closed, forgotten);
}

double JointGraph::offset_px() const { return std::get<SmallVector>(solver_.estimate(offset_))[0]; }

double JointGraph::offsetSigma_px() const {
  const auto covariance = solver_.jointCovariance(std::span(&offset_, 1));
  return covariance ? std::sqrt((*covariance)(0, 0)) : kHeldSigma_px;
}

}  // namespace motorcade
