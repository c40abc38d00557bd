#include "apps/evaluate/comparison/object_measures.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace motorcade {
namespace {

/// Error of a motion. H is transferred from the estimated to the true camera.
SE3 motionError(const AskedPair& before, const AskedPair& now) {
  const SE3 H_world = now.row->row.object.T_world_body * before.row->row.object.T_world_body.inverse();
  const SE3 H_cam = before.frame->T_world_cam.inverse() * H_world * before.frame->T_world_cam;
  const SE3 H = before.frame->T_world_cam_true * H_cam * before.frame->T_world_cam_true.inverse();
  return now.object->truth.T_world_object.inverse() * H * before.object->truth.T_world_object;
}

std::optional<TrajectoryErrors> bodyTrajectoryErrors(const FollowedLabel& followed) {
  std::vector<SE3> bodies, labels;
  for (const auto& frame : followed.frames) {
    bodies.push_back(frame.T_world_body);
    labels.push_back(frame.T_world_label);
  }
  auto errors = trajectoryErrors(bodies, labels);
  if (!errors) return errors;
  // The body's origin is arbitrary: align the box's frame with it at the first match instead of moving the world.
  const SE3 offset = bodies.front().inverse() * labels.front(), mean_offset = bodyOffset(bodies, labels);
  std::vector<double> first_m, rotation_deg;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    first_m.push_back(((bodies[i] * offset).translation() - labels[i].translation()).norm());
    rotation_deg.push_back(angleOf_deg(labels[i].rotation().transpose() * (bodies[i] * mean_offset).rotation()));
  }
  errors->end_percent = errors->length_m > 0 ? 100 * first_m.back() / errors->length_m : 0;
  errors->ate_first_pose_m = statisticsOf(std::move(first_m));
  errors->are_deg = statisticsOf(std::move(rotation_deg));
  return errors;
}

void count(DetectionCounts& counts, bool found) {
  ++counts.labels;
  counts.found += found;
}

/// Counts the false rows of one frame: rows of any state, on no label or on one that never moves.
void countRows(const ComparedFrame& frame, DetectionErrors& errors) {
  for (const auto& row : frame.rows) {
    ++errors.rows;
    if (row.object >= 0 && frame.objects[row.object].ever_moves) continue;
    ++errors.false_rows;
    errors.false_in[row.row.object.track.value].push_back(frame.frame.value);
    errors.false_rows_unlabeled += row.object < 0;
    errors.false_rows_in_ignored += row.in_ignored_area;
  }
}

void countLabels(const ComparedFrame& frame, DetectionErrors& errors) {
  std::set<int> found;
  for (const auto& row : frame.rows)
    if (row.reported()) found.insert(row.object);
  for (std::size_t j = 0; j < frame.objects.size(); ++j) {
    const TrueObject& object = frame.objects[j];
    if (!object.asked() || object.range_m() > kFar_m) continue;
    const bool is_found = found.contains(static_cast<int>(j)), near = object.range_m() <= kNear_m;
    count(near ? errors.within_30m : errors.from_30_to_50m, is_found);
    if (near && !is_found) errors.missed_in[object.truth.id].push_back(frame.frame.value);
    constexpr int kFirstFrames = 4;  // in which a tracker may still be confirming the object
    if (object.visible_before >= kFirstFrames)
      count(near ? errors.within_30m_from_fifth : errors.from_30_to_50m_from_fifth, is_found);
  }
}

}  // namespace

std::vector<ObjectStepError> objectStepErrors(const std::vector<AskedPair>& pairs) {
  std::map<std::pair<std::int64_t, TrackId>, AskedPair> last;
  std::vector<ObjectStepError> errors;
  for (const auto& pair : pairs) {
    const auto label = pair.object->truth.id;
    const TrackId track = pair.row->row.object.track;
    const auto before = last.find({label, track});
    if (before != last.end() && before->second.frame->frame.value + 1 == pair.frame->frame.value)
      errors.push_back({pair.frame->frame, label, track, motionError(before->second, pair)});
    last.insert_or_assign({label, track}, pair);
  }
  return errors;
}

MotionErrors motionErrors(const std::vector<ComparedFrame>& frames, std::optional<std::int64_t> label) {
  auto pairs = askedPairs(frames);
  if (label) std::erase_if(pairs, [&](const AskedPair& pair) { return pair.object->truth.id != *label; });
  std::vector<double> me_m, me_deg, speed_mps;
  int covered = 0;
  MotionErrors errors;
  for (const auto& step : objectStepErrors(pairs)) {
    me_m.push_back(step.error.translation().norm());
    me_deg.push_back(angleOf_deg(step.error.rotation()));
  }
  for (const auto& pair : pairs) {
    const ObjectEstimate& estimate = pair.row->row.object;
    speed_mps.push_back(estimate.velocity_world_mps.norm() - pair.object->speed_mps);
    errors.speed_bias_mps += speed_mps.back();
    covered += std::abs(speed_mps.back()) <= kSigmas95 * estimate.speed_sigma_mps;
  }
  const double n = std::max<double>(1, static_cast<double>(speed_mps.size()));
  errors.speed_bias_mps /= n;
  errors.speed_coverage = covered / n;
  errors.me_m = statisticsOf(std::move(me_m));
  errors.me_deg = statisticsOf(std::move(me_deg));
  errors.speed_mps = statisticsOf(std::move(speed_mps));
  return errors;
}

std::vector<ObjectErrors> objectErrors(const std::vector<ComparedFrame>& frames) {
  std::map<std::int64_t, ObjectErrors> by_label;
  for (const auto& frame : frames) {
    for (const auto& object : frame.objects) {
      if (!object.asked()) continue;
      ObjectErrors& errors = by_label[object.truth.id];
      errors.label = object.truth.id;
      errors.type = object.truth.type;
      ++errors.labeled_frames;
    }
  }
  std::map<std::int64_t, FollowedLabel> longest;
  for (const auto& followed : followedLabels(frames)) {
    ObjectErrors& errors = by_label[followed.label];
    errors.followed_frames += static_cast<int>(followed.frames.size());
    ++errors.tracks;
    if (longest[followed.label].frames.size() < followed.frames.size()) longest[followed.label] = followed;
  }
  std::vector<ObjectErrors> result;
  for (auto& [label, errors] : by_label) {
    const FollowedLabel& followed = longest[label];
    errors.track = followed.track;
    errors.trajectory = bodyTrajectoryErrors(followed);
    errors.positions = positionErrors(followed);
    errors.motion = motionErrors(frames, label);
    result.push_back(std::move(errors));
  }
  return result;
}

DetectionErrors detectionErrors(const std::vector<ComparedFrame>& frames) {
  DetectionErrors errors;
  for (const auto& frame : frames) {
    countLabels(frame, errors);
    countRows(frame, errors);
  }
  std::map<std::int64_t, TrackId> last_track;
  for (const auto& pair : askedPairs(frames)) {
    const TrackId track = pair.row->row.object.track;
    const auto [last, is_new] = last_track.try_emplace(pair.object->truth.id, track);
    if (!is_new && last->second != track) ++errors.id_switches;
    last->second = track;
  }
  const int labels = errors.within_30m.labels + errors.from_30_to_50m.labels;
  const int missed = labels - errors.within_30m.found - errors.from_30_to_50m.found;
  errors.mota = labels > 0 ? 1 - static_cast<double>(missed + errors.false_rows + errors.id_switches) / labels : 0;
  return errors;
}

}  // namespace motorcade
