#include "backend/joint/joint_graph.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <iterator>
#include <sstream>

namespace motorcade {
namespace {

constexpr double kComparedShare = 0.5;  // objects turn little: a factor is seldom off by the turns of several poses
constexpr int kKeptEliminations = 10;   // of update matrices: those of older poses are hardly ever asked for
constexpr int kRespondingLandmarks = 60, kResponse_frames = 12, kEarlyFrames = 8;  // see CalibrationResponse
constexpr int kEarlierViews = 3;  // of a point whose body is found: one that took longer may be of two
static_assert(kEarlierViews < UndecidedPoints::kMostViews);

IncrementalSolver::Params solverParams(const JointParams& params, const WindowParams& window) {
  IncrementalSolver::Params solver = windowSolverParams(window);
  solver.relinearization.mismatch_tolerance = params.mismatch_tolerance;
  solver.relinearization.compared_share = kComparedShare;
  solver.relinearization.jacobian_drift_sigmas = params.jacobian_drift_sigmas;
  solver.substitution_tolerance = params.substitution_tolerance;
  solver.spread_scalars = params.spread_scalars;
  solver.iterations_per_update = params.iterations_per_update;
  if (solver.budget.scalars == 0) solver.budget.scalars = params.relinearized_scalars;
  solver.kept_eliminations = kKeptEliminations;
  return solver;
}

LandmarkBundles::Params objectBundles(const JointParams& params, const StereoCamera& camera) {
  BodyPoints::Params points = pointParams(params, camera, params.object_track_frames, params.max_object_landmarks);
  points.oldest_kept_frames = params.object_kept_frames;
  return {.pose = FramePose::kCamBody,
          .noise = params.object_noise,
          .points = points,
          .newest = IncrementalSolver::Lifetime::kProvisional,
          .closing_frames = params.frames_per_factor,
          .from_estimates = false,  // a vehicle's points may slide
          .tells_shake = false};
}

/// True in frames 1, 2, 4 and 8, then in one of some: the first frames have little to compare with.
bool respondsIn(std::int64_t frame) {
  if (frame <= kEarlyFrames) return std::has_single_bit(static_cast<std::uint64_t>(frame));
  return frame % kResponse_frames == kEarlyFrames;
}

/// An object's poses seen from the camera, in the frames that the window holds.
PoseVariable posesOf(const ObjectTrack& track) {
  return [&track](FrameId frame) {
    const auto record = track.records.find(frame);
    return record == track.records.end() ? VariableId{} : record->second.pose;
  };
}

}  // namespace

JointGraph::JointGraph(const JointParams& params, const WindowParams& window, const StereoCamera& camera)
    : SmoothingWindow(solverParams(params, window), "travel"),
      params_(requireValid(params)),
      window_frames_(window.window_frames),
      camera_(camera),
      offset_(solver_, params.offset_sigma_px),
      shake_(params.shake_sigma_px),
      cameras_(params_, solver_, frames_),
      at_rest_(params_, camera_, solver_, offset_, shake_),
      objects_(params_, window.use_smoothness, solver_, frames_),
      response_(camera_, requireValid(window.calibration), params_.static_noise,
                pointParams(params_, camera_, params_.track_frames, kRespondingLandmarks)),
      considers_calibration_(window.compute_covariances) {
  calibration_ = ConsideredCalibration(camera_, window.calibration);
}

/// Adds the camera before the objects. Objects are predicted from its pose, and their motion is told from the pose at
/// which it was then found. With objects, models are corrected in the second update, as the factors of the objects'
/// previous frame are replaced before it.
void JointGraph::add(const FrameMeasurements& measurements) {
  problems_.clear();
  std::erase_if(landmarks_, [this](const auto& body) { return !tracks_.contains(body.first); });
  addCamera(measurements);
  at_rest_.add(frame_count_, frames_, leavingWithin(params_.frames_per_elimination));
  const bool alone = tracks_.empty() && measurements.objects.empty();
  dropTroubled(solver_.update(alone ? IncrementalSolver::Correction::kNow : IncrementalSolver::Correction::kLater));
  addObjects(measurements);
  if (showsPoints(measurements.head)) undecided_.observe(measurements.head.frame, measurements.undecided);
  if (showsPoints(measurements.head)) calibrate(measurements.head.frame);
  if (considers_calibration_) consider(measurements);
  ++frame_count_;
}

/// Adds the camera. A point that rests from its second view on did so in the first; one that rests only later did not.
void JointGraph::addCamera(const FrameMeasurements& m) {
  BodyPoints& at_rest = at_rest_.bundles().points();
  if (showsPoints(m.head))
    at_rest.observe(m.head.frame, m.at_rest, [&](PointId point) { return undecided_.take(point, m.head.frame, 1); });
  frames_.emplace(m.head.frame, cameras_.add(m, at_rest_.seenAgain()));
  for (const ObjectObservation& seen : m.objects) at_rest.forget(seen.measured);
}

void JointGraph::addObjects(const FrameMeasurements& measurements) {
  for (const ObjectObservation& seen : measurements.objects)
    if (frames_.contains(seen.frame) && isFinite(seen.T_cam_body)) addObservation(seen);
  if (tracks_.empty()) return;
  for (auto& [id, track] : tracks_) {
    if (!track.has_gauge && track.records.rbegin()->second.pose.valid()) objects_.hold(track);
    LandmarkBundles& landmarks = landmarksOf(id);
    const bool seen_now = track.records.rbegin()->first == measurements.head.frame;
    if (!seen_now && showsPoints(measurements.head))
      landmarks.points().observe(measurements.head.frame, {});  // its tracks end
    objects_.renewMotion(track, measurements.head.frame);
    landmarks.renew(frame_count_, posesOf(track), leavingWithin(1));
  }
  dropTroubled(solver_.update());
}

LandmarkBundles& JointGraph::landmarksOf(TrackId id) {
  const auto known = landmarks_.find(id);
  if (known != landmarks_.end()) return known->second;
  const LandmarkBundles landmarks(objectBundles(params_, camera_), NoiseLevel::like(at_rest_.noise()), camera_, solver_,
                                  offset_, shake_);
  return landmarks_.emplace(id, landmarks).first->second;
}

void JointGraph::addObservation(const ObjectObservation& seen) {
  ObjectTrack& track = tracks_[seen.track];
  LandmarkBundles& landmarks = landmarksOf(seen.track);
  if (track.records.contains(seen.frame)) return;
  const auto last = track.records.empty() ? track.records.end() : std::prev(track.records.end());
  const ObjectRecord* before = last != track.records.end() && last->second.pose.valid() ? &last->second : nullptr;
  ObjectRecord& record = addRecord(track, seen);
  if (before)
    objects_.extend(track, *before, record);
  else if (seen.state == ObjectState::kPredicted)
    return;  // nothing to predict from
  else
    objects_.begin(track, record);
  if (!showsPoints(frames_.at(seen.frame).head)) return;
  landmarks.points().observe(seen.frame, seen.measured,
                             [&](PointId point) { return undecided_.take(point, seen.frame, kEarlierViews); });
}

/// Considers the calibration's errors. The response changes little from frame to frame, so where it is computed, it
/// holds for all of the newest frames.
void JointGraph::consider(const FrameMeasurements& measurements) {
  const auto set = [this](FrameId before, FrameId now, const ConsideredCalibration::PoseShifts& shifts) {
    calibration_.set(now, {.seconds = secondsBetween(frames_.at(before).head.stamp, frames_.at(now).head.stamp),
                           .T_before_now = cameraPose(before).inverse() * cameraPose(now),
                           .T_world_now = cameraPose(now),
                           .shifts = shifts});
  };
  const auto newest = frames_.rbegin();
  if (frames_.size() > 1) set(std::next(newest)->first, newest->first, response_.ofNewestStep());
  if (!showsPoints(measurements.head)) return;
  response_.observe(newest->first, measurements.at_rest);
  if (!respondsIn(frame_count_)) return;
  const auto pose = [this](VariableId camera) { return solver_.pose(camera); };
  for (const auto& step : response_.steps(camerasOf(frames_), pose, at_rest_.noise(), offset_.px()))
    set(step.before, step.now, step.shifts);
}

void JointGraph::calibrate(FrameId newest) {
  if (offset_.release(newest)) {
    dropTroubled(solver_.update());
    tellOfOffset();
  }
  if (offset_.hasMoved()) linearizeLandmarksAnew();
  if (!offset_.isDecided(newest)) return;
  at_rest_.bundles().fix();
  for (auto& [id, landmarks] : landmarks_) landmarks.fix();
}

/// Reports an offset that the calibration's deviation makes unlikely: it is a fault of the rig or of the calibration.
void JointGraph::tellOfOffset() {
  constexpr double kUnlikely_sigmas = 3;
  const double offset_px = offset_.px(), sigma_px = calibration_.sigmas().disparity_px;
  if (std::abs(offset_px) <= kUnlikely_sigmas * sigma_px) return;
  std::ostringstream text;
  text << std::setprecision(2) << "disparities are too " << (offset_px > 0 ? "small" : "large") << " by about "
       << std::abs(offset_px) << " px, where the calibration is said to be exact to " << sigma_px
       << " px (calibration.disparity_px); the estimate allows for it, a new calibration would be better";
  problems_.push_back(text.str());
}

/// Eliminates landmarks anew that were eliminated at another offset.
void JointGraph::linearizeLandmarksAnew() {
  offset_.holdAsEliminated();
  at_rest_.relinearize(frames_);
  for (const auto& [id, track] : tracks_) landmarksOf(id).relinearize(posesOf(track));
  dropTroubled(solver_.update());
}

void JointGraph::converge() {
  constexpr double kConverged = 1e-6;  // m or rad: far below what is published
  problems_.clear();
  if (at_rest_.eliminateAligned(frame_count_ - 1, frames_)) dropTroubled(solver_.update());
  dropTroubled(solver_.converge(params_.final_iterations, kConverged));
}

void JointGraph::dropped(TrackId id) { landmarksOf(id).drop(); }

/// The last of the frames that leave the window within so many frames, this one included; none while it fills.
FrameId JointGraph::leavingWithin(int frames) const {
  const std::ptrdiff_t leaving = std::min(std::ssize(frames_) - window_frames_ + frames - 1, std::ssize(frames_));
  return window_frames_ > 0 && leaving > 0 ? std::next(frames_.begin(), leaving - 1)->first : FrameId{};
}

void JointGraph::retiring(FrameId oldest) {
  cameras_.forgetStart();
  shake_.forget(oldest);
  at_rest_.bundles().retire(oldest);
  for (auto& [id, landmarks] : landmarks_) landmarks.retire(oldest);
}

std::string JointGraph::nameOf(VariableId v) const {
  return v == offset_.variable() ? "disparity offset" : SmoothingWindow::nameOf(v);
}

SolverCounters JointGraph::counters() const {
  SolverCounters counters = solver_.counters();
  counters.disparity_offset_px = offset_.px();
  counters.disparity_offset_sigma_px = offset_.sigma_px();
  counters.disparity_shake_px = shake_.sigma_px();
  return counters;
}

}  // namespace motorcade
