#include "apps/view/run_truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "apps/evaluate/comparison/object_measures.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "io/truth/ground_truth.hpp"

namespace motorcade {
namespace {

/// Frames this close to a worse one show the same.
constexpr std::int64_t kClose = 5;
constexpr std::size_t kMostWorst = 10;

/// Motion errors of objects [m], keyed by frame and label.
using MotionErrorsOfRows = std::map<std::pair<FrameId, std::int64_t>, double>;

MotionErrorsOfRows motionErrorsOfRows(const std::vector<ComparedFrame>& frames) {
  MotionErrorsOfRows errors_m;
  for (const ObjectStepError& step : objectStepErrors(askedPairs(frames)))
    errors_m[{step.frame, step.label}] = step.error.translation().norm();
  return errors_m;
}

ShownTrueObject shownOf(const TrueObject& object, const SE3& T_world_cam) {
  return {.label = object.truth.id,
          .type = object.truth.type,
          .T_world_object = T_world_cam * object.truth.T_cam_object,
          .size_m = object.truth.size_m,
          .moving = object.asked()};
}

std::vector<ShownTrueObject> shownObjects(const ComparedFrame& frame, const MotionErrorsOfRows& motion_m) {
  std::vector<ShownTrueObject> shown;
  for (const TrueObject& object : frame.objects) shown.push_back(shownOf(object, frame.T_world_cam));
  for (const MatchedRow& row : frame.rows) {
    if (row.object < 0) continue;
    ShownTrueObject& object = shown[static_cast<std::size_t>(row.object)];
    object.track = row.row.object.track;
    object.off_m = row.distance_m;
    if (const auto found = motion_m.find({frame.frame, object.label}); found != motion_m.end())
      object.motion_m = found->second;
  }
  return shown;
}

void addSteps(std::vector<ShownTruth>& shown, const std::vector<ComparedFrame>& frames) {
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const ComparedFrame &before = frames[i - 1], &now = frames[i];
    const SE3 error = stepError(before.T_world_cam, now.T_world_cam, before.T_world_cam_true, now.T_world_cam_true);
    shown[i].step_m = error.translation().norm();
    shown[i].step_deg = angleOf_deg(error.rotation());
  }
}

/// Adds the position errors and their root mean square [m], with the path aligned to the truth as a whole.
void addPositions(RunTruth& truth, const std::vector<ComparedFrame>& frames) {
  std::vector<SE3> estimate, true_path;
  for (const ComparedFrame& frame : frames) {
    estimate.push_back(frame.T_world_cam);
    true_path.push_back(frame.T_world_cam_true);
  }
  const SE3 T_true_estimate = frames.size() > 2 ? alignPositions(estimate, true_path) : SE3();
  double sum_m2 = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double off_m = ((T_true_estimate * estimate[i]).translation() - true_path[i].translation()).norm();
    truth.frames[i].position_m = off_m;
    sum_m2 += off_m * off_m;
    truth.on_path.push_back(T_true_estimate.inverse() * true_path[i]);
  }
  truth.ate_m = std::sqrt(sum_m2 / static_cast<double>(frames.size()));
}

std::vector<AskedLabel> askedLabels(const std::vector<ComparedFrame>& frames) {
  std::map<std::int64_t, AskedLabel> labels;
  std::map<std::int64_t, std::vector<std::int64_t>> asked;
  for (const ComparedFrame& frame : frames)
    for (const TrueObject& object : frame.objects) {
      if (!object.asked()) continue;
      labels.try_emplace(object.truth.id, AskedLabel{.label = object.truth.id, .type = object.truth.type});
      asked[object.truth.id].push_back(frame.frame.value);
    }
  for (const AskedPair& pair : askedPairs(frames)) {
    std::vector<TrackId>& tracks = labels.at(pair.object->truth.id).tracks;
    const TrackId track = pair.row->row.object.track;
    if (std::ranges::find(tracks, track) == tracks.end()) tracks.push_back(track);
  }
  std::vector<AskedLabel> all;
  for (auto& [id, label] : labels) {
    label.spans = spansOf(asked[id]);
    all.push_back(std::move(label));
  }
  return all;
}

/// Keeps the largest of errors that are close to each other; `errors` are sorted, the largest first.
template <class Error>
void thin(std::vector<Error>& errors) {
  std::vector<Error> kept;
  for (const Error& error : errors) {
    const bool near = std::ranges::any_of(
        kept, [&](const Error& larger) { return std::abs(larger.frame.value - error.frame.value) < kClose; });
    if (!near && kept.size() < kMostWorst) kept.push_back(error);
  }
  errors = std::move(kept);
}

}  // namespace

std::vector<FrameSpan> spansOf(const std::vector<std::int64_t>& frames) {
  std::vector<FrameSpan> spans;
  for (const std::int64_t frame : frames) {
    if (spans.empty() || frame > spans.back().to + 1) spans.push_back({frame, frame});
    spans.back().to = frame;
  }
  return spans;
}

std::optional<RunTruth> readRunTruth(const RunFolder& run, const Sequence& sequence) {
  const auto camera = readCameraTruth(sequence);
  if (!camera || run.first_frame < camera->first_frame || run.first_frame >= std::ssize(camera->T_world_cam)) return {};
  const auto objects = readObjectTruths(sequence, *camera);
  const auto frames =
      compareFrames(fullerTrajectories(run), run.first_frame, *camera, objects ? &*objects : nullptr, sequence.stamps);
  if (frames.empty()) return {};
  RunTruth truth{.source = camera->source, .object_source = objects ? objects->source : ""};
  const auto motion_m = motionErrorsOfRows(frames);
  for (const ComparedFrame& frame : frames)
    truth.frames.push_back({.T_world_cam = frame.T_world_cam_true, .objects = shownObjects(frame, motion_m)});
  addSteps(truth.frames, frames);
  addPositions(truth, frames);
  truth.labels = askedLabels(frames);
  truth.worst = worstFrames(frames, std::numeric_limits<std::size_t>::max());
  thin(truth.worst.camera);
  thin(truth.worst.objects);
  return truth;
}

}  // namespace motorcade
