#include "apps/evaluate/comparison/object_matching.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/evaluate/comparison/overlap.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "core/assignment.hpp"

namespace motorcade {
namespace {

/// Limits of the labels that are asked for: KITTI's moderate level, with the truncation of its hard one.
constexpr double kMaxTruncated = 0.5, kMinHeight_px = 25;
constexpr int kMaxOccluded = 1;           // partly
constexpr std::int64_t kSpeedFrames = 3;  // before and after the frame, over which a label's speed is taken

bool isCounted(const ObjectTruth& truth) {
  return truth.occluded <= kMaxOccluded && truth.truncated <= kMaxTruncated &&
         truth.box.bottom_px - truth.box.top_px >= kMinHeight_px;
}

/// Fills in the motion of one label's track, its frames in order.
void describeTrack(const std::vector<TrueObject*>& track, const std::vector<Timestamp>& stamps, bool traveling) {
  const auto position_m = [&](std::size_t i) { return track[i]->truth.T_world_object.translation(); };
  const auto stamp = [&](std::size_t i) { return stamps[track[i]->truth.frame.value]; };
  int visible = 0;
  bool ever_moves = false;
  for (std::size_t i = 0; i < track.size(); ++i) {
    std::size_t from = i, to = i;
    while (from > 0 && track[i]->truth.frame.value - track[from - 1]->truth.frame.value <= kSpeedFrames) --from;
    while (to + 1 < track.size() && track[to + 1]->truth.frame.value - track[i]->truth.frame.value <= kSpeedFrames)
      ++to;
    TrueObject& object = *track[i];
    const double span_s = secondsBetween(stamp(from), stamp(to));
    object.speed_mps = span_s > 0 ? (position_m(to) - position_m(from)).norm() / span_s : 0;
    object.moving = traveling && object.speed_mps > kMovingSpeed_mps;
    object.counted = isCounted(object.truth);
    object.visible_before = visible;
    if (object.counted) ++visible;
    ever_moves |= object.moving;
  }
  for (TrueObject* object : track) object->ever_moves = ever_moves;
}

double gateOf_m(const ObjectTruth& truth) {
  constexpr double kLeast_m = 3, kPerDepth = 0.08;
  return std::max(kLeast_m, truth.size_m.z() / 2 + kPerDepth * truth.T_cam_object.translation().z());
}

bool mostlyInside(const Box& box, const Box& area) {
  constexpr double kShare = 0.5;
  return overlapArea(box, area) >= kShare * (box.right_px - box.left_px) * (box.bottom_px - box.top_px) &&
         overlapArea(box, area) > 0;
}

/// The middle of a row's cuboid, the point that a label gives. Without a cuboid it is the body's origin, an arbitrary
/// point on it.
Eigen::Vector3d middleOf(const ObjectEstimate& object) {
  return object.cuboid ? object.T_world_body * object.cuboid->center_body : object.T_world_body.translation();
}

void matchRows(ComparedFrame& frame) {
  constexpr double kForbidden_m = 1e6;  // far above any gate: pairs come before short distances
  Eigen::MatrixXd cost_m(frame.rows.size(), frame.objects.size());
  for (std::size_t i = 0; i < frame.rows.size(); ++i) {
    const Eigen::Vector3d seen = frame.T_world_cam.inverse() * middleOf(frame.rows[i].row.object);
    for (std::size_t j = 0; j < frame.objects.size(); ++j) {
      const Eigen::Vector3d offset = seen - frame.objects[j].truth.T_cam_object.translation();
      const double distance_m = std::hypot(offset.x(), offset.z());
      cost_m(i, j) = distance_m <= gateOf_m(frame.objects[j].truth) ? distance_m : 2 * kForbidden_m;
    }
  }
  const auto columns = assignMinCost(cost_m, kForbidden_m);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    MatchedRow& row = frame.rows[i];
    row.object = columns[i];
    if (row.object < 0) continue;
    row.distance_m = cost_m(i, row.object);
    row.gate_m = gateOf_m(frame.objects[row.object].truth);
  }
}

}  // namespace

double TrueObject::range_m() const {
  return std::hypot(truth.T_cam_object.translation().x(), truth.T_cam_object.translation().z());
}

std::vector<AskedPair> askedPairs(const std::vector<ComparedFrame>& frames, double from_m, double to_m) {
  std::vector<AskedPair> pairs;
  for (const auto& frame : frames) {
    for (const auto& row : frame.rows) {
      if (row.object < 0 || !row.reported()) continue;
      const TrueObject& object = frame.objects[row.object];
      if (object.asked() && object.range_m() >= from_m && object.range_m() < to_m)
        pairs.push_back({&frame, &object, &row});
    }
  }
  return pairs;
}

std::vector<AskedPair> movingPairs(const std::vector<ComparedFrame>& frames) {
  std::vector<AskedPair> pairs;
  for (const auto& frame : frames)
    for (const auto& row : frame.rows)
      if (row.object >= 0 && frame.objects[row.object].moving)
        pairs.push_back({&frame, &frame.objects[row.object], &row});
  return pairs;
}

std::map<const MatchedRow*, int> rowsBefore(const std::vector<ComparedFrame>& frames) {
  std::map<const MatchedRow*, int> rows_before;
  std::map<TrackId, int> rows_of_track;
  for (const ComparedFrame& frame : frames)
    for (const MatchedRow& row : frame.rows) rows_before[&row] = rows_of_track[row.row.object.track]++;
  return rows_before;
}

std::map<FrameId, std::vector<TrueObject>> describeObjects(const ObjectTruths& truths,
                                                           const std::vector<Timestamp>& stamps) {
  std::map<FrameId, std::vector<TrueObject>> frames;
  for (const auto& truth : truths.objects) {
    if (!std::cmp_less(truth.frame.value, stamps.size())) continue;
    TrueObject object;
    object.truth = truth;
    frames[truth.frame].push_back(std::move(object));
  }
  std::map<std::int64_t, std::vector<TrueObject*>> tracks;
  for (auto& [frame, objects] : frames)
    for (auto& object : objects) tracks[object.truth.id].push_back(&object);
  const auto traveling = travelingLabels(truths.objects, stamps);
  for (const auto& [id, track] : tracks) describeTrack(track, stamps, traveling.contains(id));
  return frames;
}

std::vector<ComparedFrame> compareFrames(const RunFolder::Trajectories& trajectories, std::int64_t first_frame,
                                         const CameraTruth& camera, const ObjectTruths* truths,
                                         const std::vector<Timestamp>& stamps) {
  std::map<FrameId, std::vector<TrueObject>> objects;
  if (truths) objects = describeObjects(*truths, stamps);
  std::vector<ComparedFrame> frames;
  const auto count = static_cast<std::size_t>(
      std::clamp<std::int64_t>(std::ssize(camera.T_world_cam) - first_frame, 0, std::ssize(trajectories.camera)));
  if (count == 0) return frames;
  const SE3 T_run_world = camera.T_world_cam[first_frame].inverse();
  for (std::size_t i = 0; i < count; ++i) {
    ComparedFrame frame;
    frame.frame.value = first_frame + static_cast<std::int64_t>(i);
    frame.T_world_cam = trajectories.camera[i];
    frame.T_world_cam_true = T_run_world * camera.T_world_cam[frame.frame.value];
    frame.objects = objects[frame.frame];
    for (auto& object : frame.objects) object.truth.T_world_object = T_run_world * object.truth.T_world_object;
    frames.push_back(std::move(frame));
  }
  for (const auto& row : trajectories.objects) {
    const std::int64_t index = row.frame.value - first_frame;
    if (index < 0 || index >= std::ssize(frames)) continue;
    MatchedRow matched;
    matched.row = row;
    frames[index].rows.push_back(std::move(matched));
  }
  for (auto& frame : frames) matchRows(frame);
  if (!truths) return frames;
  for (const auto& ignored : truths->ignored) {
    const std::int64_t index = ignored.frame.value - first_frame;
    if (index < 0 || index >= std::ssize(frames)) continue;
    for (auto& row : frames[index].rows) {
      if (row.object < 0 && mostlyInside(row.row.object.box, ignored.box)) row.in_ignored_area = true;
    }
  }
  return frames;
}

}  // namespace motorcade
