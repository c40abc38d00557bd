#include "apps/evaluate/measures/covariance_measures.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

#include "apps/evaluate/comparison/object_positions.hpp"
#include "core/assignment.hpp"
#include "core/decompositions.hpp"

namespace motorcade {
namespace {

constexpr std::int64_t kEveryFrames = 5;

bool isTaken(FrameId frame) { return frame.value % kEveryFrames == 0; }

using CovarianceOf = std::map<std::pair<TrackId, FrameId>, Matrix6d>;

CovarianceOf byTrackAndFrame(const CovarianceRows& rows) {
  CovarianceOf covariances;
  for (const auto& row : rows) covariances[{row.track, row.frame}] = row.covariance;
  return covariances;
}

/// The frames of one pair of body frames: of a track and a label, or of two tracks.
struct SeenTrack {
  std::vector<SeenTwice> seen;
  std::vector<FrameId> frames;
};

template <class Key>
std::vector<ErrorSample> samplesOf(const std::map<Key, SeenTrack>& tracks) {
  std::vector<ErrorSample> samples;
  for (const auto& [key, track] : tracks) {
    if (track.frames.size() < kLeastFramesOfMean) continue;
    const auto errors = errorsWithoutOffset(track.seen);
    for (std::size_t i = 0; i < errors.size(); ++i)
      if (isTaken(track.frames[i])) samples.push_back(errors[i]);
  }
  return samples;
}

/// A run's online estimates, indexed by frame.
struct HalfRun {
  explicit HalfRun(const RunFolder& run) : folder(run), covariances(byTrackAndFrame(run.online.covariances)) {
    for (const auto& row : run.online.objects)
      if (covariances.contains({row.object.track, row.frame})) rows[row.frame].push_back(&row.object);
  }
  std::int64_t frames() const { return std::ssize(folder.online.camera); }
  const SE3& T_world_cam(FrameId frame) const { return folder.online.camera[frame.value - folder.first_frame]; }
  const Matrix6d* covarianceOf(TrackId track, FrameId frame) const {
    const auto found = covariances.find({track, frame});
    return found == covariances.end() ? nullptr : &found->second;
  }
  SE3 motionTo(FrameId now) const {
    return T_world_cam({now.value - kCameraCovarianceFrames}).inverse() * T_world_cam(now);
  }
  SE3 T_cam_body(const ObjectEstimate& object, FrameId frame) const {
    return T_world_cam(frame).inverse() * object.T_world_body;
  }

  const RunFolder& folder;
  CovarianceOf covariances;
  std::map<FrameId, std::vector<const ObjectEstimate*>> rows;
};

std::vector<ErrorSample> cameraDifferences(const HalfRun& a, const HalfRun& b) {
  std::vector<ErrorSample> samples;
  const std::int64_t first = a.folder.first_frame, end = first + std::min(a.frames(), b.frames());
  for (FrameId now{first + kCameraCovarianceFrames}; now.value < end; ++now.value) {
    const Matrix6d *of_a = a.covarianceOf({}, now), *of_b = b.covarianceOf({}, now);
    if (!isTaken(now) || !of_a || !of_b) continue;
    samples.push_back({(a.motionTo(now).inverse() * b.motionTo(now)).log(), *of_a + *of_b});
  }
  return samples;
}

using TrackPair = std::pair<TrackId, TrackId>;

/// Adds the objects that both runs see in a frame.
void addSeenByBoth(const HalfRun& a, const HalfRun& b, FrameId frame, std::map<TrackPair, SeenTrack>& tracks) {
  constexpr double kGate_m = 3;  // less than between two cars
  const auto of_a = a.rows.find(frame), of_b = b.rows.find(frame);
  if (of_a == a.rows.end() || of_b == b.rows.end()) return;
  const auto &rows_a = of_a->second, &rows_b = of_b->second;
  Eigen::MatrixXd cost_m(rows_a.size(), rows_b.size());
  for (std::size_t i = 0; i < rows_a.size(); ++i)
    for (std::size_t j = 0; j < rows_b.size(); ++j)
      cost_m(i, j) =
          (a.T_cam_body(*rows_a[i], frame).translation() - b.T_cam_body(*rows_b[j], frame).translation()).norm();
  const auto columns = assignMinCost(cost_m, kGate_m);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] < 0) continue;
    const ObjectEstimate &mine = *rows_a[i], &theirs = *rows_b[columns[i]];
    SeenTrack& track = tracks[{mine.track, theirs.track}];
    track.seen.push_back({a.T_cam_body(mine, frame), b.T_cam_body(theirs, frame), *a.covarianceOf(mine.track, frame),
                          *b.covarianceOf(theirs.track, frame)});
    track.frames.push_back(frame);
  }
}

ErrorSample motionError(const ComparedFrame& from, const ComparedFrame& to, const Matrix6d& covariance,
                        const SE3& T_true_cam) {
  const SE3 estimate = from.T_world_cam.inverse() * to.T_world_cam,
            truth = (from.T_world_cam_true * T_true_cam).inverse() * to.T_world_cam_true * T_true_cam;
  return {(estimate.inverse() * truth).log(), covariance};
}

/// The index of a row's frame; empty where there is no such frame.
std::optional<std::int64_t> placeOf(const RunFolder::CovarianceRow& row, const std::vector<ComparedFrame>& frames) {
  const std::int64_t place = frames.empty() ? -1 : row.frame.value - frames.front().frame.value;
  if (place < 0 || place >= std::ssize(frames)) return std::nullopt;
  return place;
}

/// The error of the camera's motion to a row's frame; empty where the frames do not reach back far enough.
std::optional<ErrorSample> cameraError(const std::vector<ComparedFrame>& frames, const RunFolder::CovarianceRow& row,
                                       const SE3& T_true_cam) {
  const auto now = placeOf(row, frames);
  if (row.track.valid() || !now || *now < kCameraCovarianceFrames) return std::nullopt;
  std::int64_t before = *now - kCameraCovarianceFrames;
  while (before > 0 && !frames[before].entered) --before;
  return motionError(frames[before], frames[*now], row.covariance, T_true_cam);
}

}  // namespace

std::vector<ErrorSample> cameraErrorSamples(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows,
                                            const SE3& T_true_cam) {
  std::vector<ErrorSample> samples;
  for (const auto& row : rows)
    if (isTaken(row.frame))
      if (const auto sample = cameraError(frames, row, T_true_cam)) samples.push_back(*sample);
  return samples;
}

std::vector<ErrorSample> cameraPoseSamples(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows,
                                           const SE3& T_true_cam) {
  std::vector<ErrorSample> samples;
  for (const auto& row : rows) {
    const auto now = placeOf(row, frames);
    if (isTaken(row.frame) && now && *now > 0)
      samples.push_back(motionError(frames.front(), frames[*now], row.covariance, T_true_cam));
  }
  return samples;
}

std::vector<FrameNees> cameraNees(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows,
                                  const SE3& T_true_cam) {
  std::vector<FrameNees> nees;
  for (const auto& row : rows) {
    const auto sample = cameraError(frames, row, T_true_cam);
    if (!sample) continue;
    const Eigen::LLT<Matrix6d> cholesky(sample->covariance);
    if (cholesky.info() == Eigen::Success) nees.push_back({row.frame, sample->xi.dot(cholesky.solve(sample->xi))});
  }
  return nees;
}

std::vector<ErrorSample> objectErrorSamples(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows) {
  const CovarianceOf covariances = byTrackAndFrame(rows);
  std::map<std::pair<TrackId, std::int64_t>, SeenTrack> tracks;
  for (const auto& frame : frames) {
    for (const auto& row : frame.rows) {
      const auto covariance = covariances.find({row.row.object.track, frame.frame});
      if (row.object < 0 || !frame.objects[row.object].ever_moves || covariance == covariances.end()) continue;
      const ObjectTruth& truth = frame.objects[row.object].truth;
      SeenTrack& track = tracks[{row.row.object.track, truth.id}];
      track.seen.push_back(
          {frame.T_world_cam.inverse() * row.row.object.T_world_body, truth.T_cam_object, covariance->second});
      track.frames.push_back(frame.frame);
    }
  }
  return samplesOf(tracks);
}

HalfErrors compareHalves(const RunFolder& a, const RunFolder& b) {
  const HalfRun half_a(a), half_b(b);
  std::map<TrackPair, SeenTrack> tracks;
  for (const auto& [frame, rows] : half_a.rows) addSeenByBoth(half_a, half_b, frame, tracks);
  return {.camera = consistencyOf(cameraDifferences(half_a, half_b)), .objects = consistencyOf(samplesOf(tracks))};
}

}  // namespace motorcade
