#include <algorithm>

#include <nlohmann/json.hpp>

#include "apps/evaluate/report/report.hpp"
#include "io/files/json_text.hpp"
#include "io/results/object_row.hpp"

namespace motorcade {
namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const Statistics& s) {
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median}, {"p95", s.p95}, {"max", s.max}, {"count", s.count}};
}

Json jsonOf(const std::optional<TrajectoryErrors>& errors) {
  if (!errors) return nullptr;
  return {{"ate_m", jsonOf(errors->ate_m)},       {"ate_first_pose_m", jsonOf(errors->ate_first_pose_m)},
          {"are_deg", jsonOf(errors->are_deg)},   {"rpe_t_m", jsonOf(errors->rpe_m)},
          {"rpe_r_deg", jsonOf(errors->rpe_deg)}, {"end_error_percent", errors->end_percent},
          {"path_length_m", errors->length_m}};
}

Json jsonOf(const SegmentMeans& means) {
  return {{"segments", means.segments},
          {"translation_percent", means.translation_percent},
          {"rotation_deg_per_m", means.rotation_deg_per_m}};
}

Json jsonOf(const std::optional<SegmentErrors>& errors) {
  if (!errors) return nullptr;
  Json json = jsonOf(errors->all), by_length = Json::array();
  json["short_segments"] = errors->short_segments;
  for (const auto& of_length : errors->by_length) {
    if (of_length.segments == 0) continue;
    by_length.push_back({{"length_m", of_length.length_m}});
    by_length.back().update(jsonOf(static_cast<const SegmentMeans&>(of_length)));
  }
  json["by_length"] = std::move(by_length);
  return json;
}

Json cameraJson(const std::optional<TrajectoryErrors>& errors, const std::optional<SegmentErrors>& segments) {
  Json json = jsonOf(errors);
  if (errors) json["kitti"] = jsonOf(segments);
  return json;
}

Json jsonOf(const LargestStep& step, const char* name) {
  if (step.label < 0) return nullptr;
  return {{name, step.error}, {"frame", step.frame.value}, {"label", step.label}, {"track_id", step.track.value}};
}

Json jsonOf(const FollowedMotion& motion) {
  Json each = Json::array();
  for (const LabelMotion& object : motion.objects)
    each.push_back({{"label", object.label},
                    {"type", object.type},
                    {"me_t_m", jsonOf(object.me_m)},
                    {"me_r_deg", jsonOf(object.me_deg)}});
  return {{"objects", motion.objects.size()},
          {"me_t_object_rms_m", motion.rms_m},
          {"me_r_object_rms_deg", motion.rms_deg},
          {"me_t_m", jsonOf(motion.me_m)},
          {"me_r_deg", jsonOf(motion.me_deg)},
          {"largest_step", jsonOf(motion.largest_m, "me_t_m")},
          {"largest_turn", jsonOf(motion.largest_deg, "me_r_deg")},
          {"each", std::move(each)}};
}

Json jsonOf(const MotionErrors& errors) {
  return {{"me_t_m", jsonOf(errors.me_m)},
          {"me_r_deg", jsonOf(errors.me_deg)},
          {"speed_error_mps", jsonOf(errors.speed_mps)},
          {"speed_bias_mps", errors.speed_bias_mps},
          {"speed_coverage_95", errors.speed_coverage}};
}

Json jsonOf(const CoveredErrors& covered) {
  return {{"error", jsonOf(covered.errors)}, {"coverage_95", covered.coverage}};
}

Json jsonOf(const std::optional<AccelerationErrors>& errors) {
  if (!errors) return nullptr;
  return {
      {"rows", errors->rows}, {"along_mps2", jsonOf(errors->along_mps2)}, {"yaw_radps2", jsonOf(errors->yaw_radps2)}};
}

Json jsonOf(const Hota& hota) {
  return {{"labels", hota.labels}, {"rows", hota.rows},     {"hota", hota.hota},   {"det_a", hota.det_a},
          {"det_re", hota.det_re}, {"det_pr", hota.det_pr}, {"ass_a", hota.ass_a}, {"ass_re", hota.ass_re},
          {"ass_pr", hota.ass_pr}, {"loc_a", hota.loc_a}};
}

Json jsonOf(const KindRows& rows) {
  const KindCounts& counts = rows.counts;
  Json json = {{"rows", counts.total()},
               {"right", counts.shareRight()},
               {"log_loss", rows.logLoss()},
               {"sure_wrong", rows.shareSureWrong()},
               {"named", jsonOf(rows.named, "right")},
               {"confusion", Json::object()}};
  for (const ObjectKind label : kAllKinds) {
    if (label == ObjectKind::kUnknown) continue;
    for (const ObjectKind reported : kAllKinds)
      json["confusion"][std::string(kindName(label))][std::string(kindName(reported))] = counts.of(label, reported);
  }
  return json;
}

Json jsonOf(const KindErrors& kinds) {
  return {{"from_tenth_row", jsonOf(kinds.from_tenth_row)}, {"before", jsonOf(kinds.before)}};
}

Json jsonOf(const FirstReports& reports) {
  return {{"labels", reports.labels}, {"never", reports.never}, {"frames", jsonOf(reports.frames)}};
}

Json jsonOf(const MaskErrors& masks) {
  return {{"rows", masks.rows},
          {"rows_with_mask", masks.rows_with_mask},
          {"iou", masks.iou},
          {"iou_of_masks", masks.iou_of_masks},
          {"boundary_px", jsonOf(masks.boundary_px)}};
}

Json jsonOf(const std::optional<MaskEvaluation>& masks) {
  if (!masks) return nullptr;
  return {{"within_30m", jsonOf(masks->within_30m)}, {"from_30_to_50m", jsonOf(masks->from_30_to_50m)}};
}

Json jsonOf(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// A number per kind of position, by the kinds' names.
template <class NumberOf>
Json byPositionKind(const NumberOf& number_of) {
  Json json;
  for (std::size_t kind = 0; kind < kPositionKinds; ++kind) json[kPositionKindNames[kind]] = number_of(kind);
  return json;
}

Json jsonOf(const std::optional<PositionErrors>& errors) {
  if (!errors) return nullptr;
  return {{"frames", errors->frames},
          {"ate_m", byPositionKind([&](std::size_t kind) { return jsonOf(errors->ate_m[kind]); })},
          {"are_deg", jsonOf(errors->are_deg)},
          {"are_as_seen_deg", jsonOf(errors->are_as_seen_deg)},
          {"origin_drift_m", errors->origin_drift_m ? jsonOf(*errors->origin_drift_m) : Json()}};
}

Json jsonOf(const MeanPositionErrors& mean) {
  return {{"objects", mean.objects},
          {"least_frames", kLeastFramesOfMean},
          {"ate_rmse_m", byPositionKind([&](std::size_t kind) { return mean.ate_m[kind]; })},
          {"are_rmse_deg", mean.are_deg},
          {"are_as_seen_rmse_deg", mean.are_as_seen_deg},
          {"largest_origin_drift_m", jsonOf(mean.largest_drift_m)}};
}

Json jsonOf(const RelativeError& error) {
  return {{"ate_ours_m", error.ours_m}, {"ate_baseline_m", error.baseline_m}, {"relative_error", error.relative()}};
}

Json jsonOf(const ComparedObject& object) {
  return {{"label", object.label},
          {"track_id", object.track.value},
          {"baseline_track_id", object.baseline_track.value},
          {"common_frames", object.ours.frames},
          {"relative_error", byPositionKind([&](std::size_t kind) { return object.relativeError(kind); })},
          {"ours", jsonOf(std::optional(object.ours))},
          {"baseline", jsonOf(std::optional(object.baseline))}};
}

Json jsonOf(const RunComparison& comparison) {
  Json each = Json::array();
  for (const auto& object : comparison.objects) each.push_back(jsonOf(object));
  return {
      {"objects_of_mean", comparison.objects_of_mean},
      {"least_frames", kLeastFramesOfMean},
      {"mean_relative_error", byPositionKind([&](std::size_t kind) { return comparison.mean_relative_error[kind]; })},
      {"objects", std::move(each)}};
}

Json jsonOf(const ObjectErrors& object) {
  return {{"label", object.label},
          {"type", object.type},
          {"track_id", object.track.value},
          {"labeled_frames", object.labeled_frames},
          {"followed_frames", object.followed_frames},
          {"tracks", object.tracks},
          {"trajectory", jsonOf(object.trajectory)},
          {"position", jsonOf(object.positions)},
          {"motion", jsonOf(object.motion)}};
}

Json jsonOf(const BoxErrors& boxes) {
  return {{"rows", boxes.rows},
          {"rows_with_cuboid", boxes.rows_with_cuboid},
          {"iou_2d", boxes.iou_2d},
          {"over_half_2d", boxes.over_half_2d},
          {"iou_bird", boxes.iou_bird},
          {"iou_3d", boxes.iou_3d},
          {"center_m", jsonOf(boxes.center_m)},
          {"heading_deg", jsonOf(boxes.heading_deg)},
          {"length_m", jsonOf(boxes.length_m)},
          {"width_m", jsonOf(boxes.width_m)},
          {"height_m", jsonOf(boxes.height_m)},
          {"length_within_2_sigma", boxes.size_within_2_sigma.x()},
          {"width_within_2_sigma", boxes.size_within_2_sigma.y()},
          {"height_within_2_sigma", boxes.size_within_2_sigma.z()}};
}

Json jsonOf(const KindEvaluation& kind, bool with_objects) {
  Json json = {{"frames", kind.frames},
               {"camera", cameraJson(kind.camera, kind.camera_segments)},
               {"camera_mounted", cameraJson(kind.camera_mounted, kind.camera_mounted_segments)}};
  if (!with_objects) return json;
  json["objects"] = Json::array();
  for (const auto& object : kind.objects) json["objects"].push_back(jsonOf(object));
  json["objects_mean"] = jsonOf(kind.mean_positions);
  json["motion"] = jsonOf(kind.motion);
  json["followed_motion"] = jsonOf(kind.followed_motion);
  json["acceleration"] = jsonOf(kind.acceleration);
  json["detection"] = jsonOf(kind.detection);
  json["boxes_within_30m"] = jsonOf(kind.boxes_within_30m);
  json["boxes_from_30_to_50m"] = jsonOf(kind.boxes_from_30_to_50m);
  json["hota"] = {
      {"image", {{"within_30m", jsonOf(kind.image_within_30m)}, {"within_50m", jsonOf(kind.image_within_50m)}}},
      {"footprint",
       {{"within_30m", jsonOf(kind.footprint_within_30m)}, {"within_50m", jsonOf(kind.footprint_within_50m)}}}};
  json["existence"] = jsonOf(kind.existence, "real");
  json["kinds_within_30m"] = jsonOf(kind.kinds_within_30m);
  json["first_report"] = {{"within_30m", jsonOf(kind.first_within_30m)}, {"within_50m", jsonOf(kind.first_within_50m)}};
  return json;
}

Json jsonOf(const SE3& T) {
  return {{"rotation_rad", jsonOf(logSO3(T.rotation()))}, {"translation_m", jsonOf(T.translation())}};
}

Json jsonOf(const WorstFrames& worst) {
  Json camera = Json::array(), objects = Json::array();
  for (const CameraFrameError& error : worst.camera)
    camera.push_back({{"frame", error.frame.value}, {"rpe_t_m", error.rpe_t_m}, {"rpe_r_deg", error.rpe_r_deg}});
  for (const ObjectFrameError& error : worst.objects)
    objects.push_back({{"frame", error.frame.value},
                       {"label", error.label},
                       {"track_id", error.track.value},
                       {"me_t_m", error.me_t_m}});
  return {{"camera", std::move(camera)}, {"objects", std::move(objects)}};
}

Json jsonOf(const NormalizedErrors& errors) {
  return {{"mean_nees", errors.mean_nees}, {"median_nees", errors.median_nees}, {"coverage_95", errors.coverage_95}};
}

Json jsonOf(const CovarianceErrors& errors) {
  Json json = {{"samples", errors.samples}};
  json.update(jsonOf(errors.pose));
  json["position"] = jsonOf(errors.position);
  json["rotation"] = jsonOf(errors.rotation);
  json["by_axis"] = jsonOf(errors.by_axis);
  return json;
}

Json jsonOf(const TruthCheck& check) {
  return {{"way_m", check.way_m},
          {"velocity_way_m", check.velocity_way_m},
          {"difference_percent", check.differencePercent()},
          {"largest_step_m", check.largest_step_m},
          {"largest_step_frames", {check.step_from.value, check.step_to.value}},
          {"doubtful", check.doubtful()}};
}

Json jsonOf(const CovarianceEvaluation& e) {
  const auto orNull = [](const auto& errors) { return errors ? jsonOf(*errors) : Json(); };
  return {{"camera", jsonOf(e.camera)},
          {"camera_mounted", orNull(e.camera_mounted)},
          {"camera_mounted_with_truth_noise", orNull(e.camera_with_truth_noise)},
          {"camera_since_start", jsonOf(e.camera_pose)},
          {"objects", jsonOf(e.objects)}};
}

Json covarianceJson(const Evaluation& e) {
  Json nees = Json::object();
  for (const FrameNees& frame : e.camera_nees) nees[std::to_string(frame.frame.value)] = frame.nees;
  Json json = jsonOf(e.online.covariances);
  json["camera_nees_by_frame"] = nees;
  json["halves"] = nullptr;
  if (e.half_errors)
    json["halves"] = {{"camera", jsonOf(e.half_errors->camera)}, {"objects", jsonOf(e.half_errors->objects)}};
  json["final"] = jsonOf(e.final.covariances);
  return json;
}

}  // namespace

std::string jsonOf(const Evaluation& e) {
  const bool with_objects = !e.object_source.empty();
  Json json = {{"run", e.run.string()},
               {"sequence", e.sequence.string()},
               {"complete", e.complete},
               {"first_frame", e.first_frame},
               {"frames", e.frames_run},
               {"finals_recovered", e.finals_recovered},
               {"lost", e.lost},
               {"rejected", e.rejected},
               {"dropped", e.dropped},
               {"truth",
                {{"camera", e.camera_source},
                 {"objects", e.object_source},
                 {"course_difference_deg", std::max(e.final.course_difference_deg, e.online.course_difference_deg)},
                 {"velocity_check", e.truth_check ? jsonOf(*e.truth_check) : Json()}}},
               {"mounting", e.mounting ? jsonOf(*e.mounting) : Json()},
               {"final", jsonOf(e.final, with_objects)},
               {"online", jsonOf(e.online, with_objects)},
               {"worst_frames", jsonOf(e.worst)},
               {"masks", jsonOf(e.masks)},
               {"covariance", covarianceJson(e)},
               {"latency_ms",
                {{"p50", e.latencyQuantile_ms(0.5)},
                 {"p95", e.latencyQuantile_ms(0.95)},
                 {"p99", e.latencyQuantile_ms(0.99)},
                 {"max", e.latencyQuantile_ms(1)}}}};
  json["baseline"] = {{"camera", e.camera_against_baseline ? jsonOf(*e.camera_against_baseline) : Json()},
                      {"objects", e.objects_against_baseline ? jsonOf(*e.objects_against_baseline) : Json()}};
  return jsonText(json, 2);
}

}  // namespace motorcade
