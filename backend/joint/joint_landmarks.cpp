/// The part of JointGraph that turns points into factors, and finds the disparity offset by them.

#include <algorithm>
#include <cmath>

#include "backend/joint/joint_graph.hpp"

namespace motorcade {
namespace {

constexpr double kHeldSigma_px = 1e-5;    // of a held offset: very long drives do not move it either
constexpr double kClearSigma_px = 0.1;    // of an observed offset, from which on it is looked at
constexpr double kDistortion_px = 0.5;    // what looks like an offset up to here may be distortion
constexpr double kOffsetStep_px = 0.1;    // of the offset, after which landmarks are eliminated anew
constexpr int kFirstLook_frames = 8;      // after which the offset is looked at
constexpr int kCalibration_frames = 100;  // of the drive, in which the offset may be found
constexpr int kFramesPerFactor = 5;       // tracks that ended in so many frames share one

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

}  // namespace

/// The factor over the tracks that go on, and over those that ended lately, is made anew in each frame.
void JointGraph::addPoints(JointPoints& body, const JointObject* object) {
  if (body.current) solver_.removeFactor(*body.current);
  body.current.reset();
  std::ranges::move(body.points.takeEnded(), std::back_inserter(body.ended));
  if (object && !object->lever.valid()) return body.ended.clear();
  if ((first_frame_.value + added_frames_ - 1) % kFramesPerFactor == 0) closeEnded(body, object);
  std::vector<LandmarkTrack*> tracks = body.points.current();
  std::ranges::copy(pointersTo(body.ended), std::back_inserter(tracks));
  body.current = addBundle(tracks, body.noise, object);
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
                                              const JointObject* object) {
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
    for (const auto& view : track->views) {
      const int at = index.of(view.frame);
      if (at < 0) continue;
      Eigen::Vector3d sigma_px = view.sigma_px.cast<double>();
      sigma_px.head<2>() *= noise.uv();
      sigma_px.z() *= noise.d();
      landmarks.views.push_back({at, view.uvd_px.cast<double>(), sigma_px.cwiseInverse()});
    }
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
  EliminatedLandmarks eliminated = eliminateLandmarks(camera_, object ? params_.object_noise : params_.static_noise,
                                                      landmarks, std::move(T_cam_body), offset_px());
  for (std::size_t i = 0; i < landmark_tracks.size(); ++i) landmark_tracks[i]->estimate = eliminated.estimates[i];
  return solver_.addFactor(
      std::make_unique<BundleFactor>(object ? BundleFactor::Poses::kCamBody : BundleFactor::Poses::kWorldCam,
                                     std::move(poses), offset_, std::move(eliminated)));
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
    if (object.lever.valid()) relinearizeClosed(object.points, &object);
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
