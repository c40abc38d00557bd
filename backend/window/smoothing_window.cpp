#include "backend/window/smoothing_window.hpp"

#include <algorithm>
#include <iterator>

namespace motorcade {
namespace {

/// True for a problem of a variable, false for that of a factor that was left out.
bool concernsVariable(SolverProblem::Kind kind) {
  using Kind = SolverProblem::Kind;
  return kind != Kind::kNotFinite && kind != Kind::kUnknownVariable && kind != Kind::kRepeatedVariable;
}

void append(const ObjectRecord& record, std::vector<VariableId>& variables) {
  for (const VariableId v : {record.pose, record.twist})
    if (v.valid()) variables.push_back(v);
}

std::vector<VariableId> variablesOf(const ObjectTrack& track) {
  std::vector<VariableId> variables;
  if (track.shared.valid()) variables.push_back(track.shared);
  for (const auto& [frame, record] : track.records) append(record, variables);
  return variables;
}

std::optional<TrackId> objectOf(const std::map<TrackId, ObjectTrack>& tracks, VariableId v) {
  for (const auto& [id, track] : tracks)
    if (std::ranges::count(variablesOf(track), v) > 0) return id;
  return std::nullopt;
}

}  // namespace

/// Adds a record without its points: records stay for as long as the window.
ObjectRecord& SmoothingWindow::addRecord(ObjectTrack& track, const ObjectObservation& seen) {
  ObjectRecord& record = track.records[seen.frame];
  record.seen = seen;
  record.measured = static_cast<int>(seen.measured.size());
  record.seen.measured = record.seen.patches = {};
  record.stamp = frames_.at(seen.frame).head.stamp;
  return record;
}

void SmoothingWindow::retireOldest() {
  const auto [oldest, camera] = *frames_.begin();
  retiring(oldest);
  std::vector<VariableId> retired{camera.x};
  for (auto it = tracks_.begin(); it != tracks_.end();) {
    ObjectTrack& track = it->second;
    retireRecord(track, oldest, retired);
    const bool over = track.records.empty() || track.records.rbegin()->first <= oldest;
    if (over && track.shared.valid()) retired.push_back(track.shared);
    it = over ? tracks_.erase(it) : std::next(it);
  }
  solver_.retire(retired);
  calibration_.forget(oldest);
  frames_.erase(frames_.begin());
}

void SmoothingWindow::retireRecord(ObjectTrack& track, FrameId oldest, std::vector<VariableId>& retired) {
  track.records.erase(track.records.begin(), track.records.lower_bound(oldest));
  const auto record = track.records.find(oldest);
  if (record == track.records.end()) return;
  record->second.frozen = objectPose(track, oldest);
  append(record->second, retired);
  record->second.pose = record->second.twist = {};
  if (const auto next = std::next(record); next != track.records.end()) next->second.motion.reset();
}

void SmoothingWindow::keep(FrameId frame, const FrameCovariances& covariances) {
  CameraCovariances& camera = frames_.at(frame).covariances;
  if (covariances.camera.motion) camera.motion = covariances.camera.motion;
  if (covariances.camera.pose) camera.pose = covariances.camera.pose;
  for (const auto& [id, object] : covariances.objects) tracks_.at(id).records.at(frame).covariances = object;
}

std::string SmoothingWindow::nameOf(VariableId v) const {
  for (const auto& [frame, camera] : frames_)
    if (camera.x == v) return "camera pose of frame " + std::to_string(frame.value);
  for (const auto& [id, track] : tracks_) {
    const std::string of_object = " of object " + std::to_string(id.value);
    if (track.shared == v) return shared_name_ + of_object;
    for (const auto& [frame, record] : track.records) {
      const std::string in_frame = of_object + " in frame " + std::to_string(frame.value);
      if (record.pose == v) return "pose" + in_frame;
      if (record.twist == v) return "twist" + in_frame;
    }
  }
  return "a variable that is gone";
}

/// Drops objects with problems until none has any: dropping one may make another one undetermined.
void SmoothingWindow::dropTroubled(const IncrementalSolver::Report& report) {
  std::vector<SolverProblem> found = report.problems;
  while (!found.empty()) {
    std::vector<TrackId> troubled;
    for (const SolverProblem& problem : found) {
      const auto object = concernsVariable(problem.kind) ? objectOf(tracks_, problem.variable) : std::nullopt;
      if (object) troubled.push_back(*object);
      const std::string text = describe(problem, solver_.graph(), [&](VariableId v) { return nameOf(v); });
      problems_.push_back(object ? "object " + std::to_string(object->value) + " is dropped: " + text : text);
    }
    found.clear();
    for (const TrackId id : troubled) {
      ObjectTrack& track = tracks_.at(id);
      if (!track.shared.valid()) continue;  // dropped just now
      const auto& after = solver_.drop(variablesOf(track));
      found.insert(found.end(), after.problems.begin(), after.problems.end());
      track.shared = {};
      for (auto& [frame, record] : track.records) record.pose = record.twist = {}, record.motion.reset();
      dropped(id);
    }
  }
}

}  // namespace motorcade
