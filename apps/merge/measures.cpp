#include "apps/merge/measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

namespace motorcade {
namespace {

constexpr auto kLower = Better::kLower, kHigher = Better::kHigher, kNeither = Better::kNeither;

constexpr std::array kMeasures{
    Measure{"frames", "/frames", "", kNeither},
    Measure{"camera_ate_m", "/final/camera/ate_m/rmse", "", kLower},
    Measure{"camera_end_error_percent", "/final/camera/end_error_percent", "", kLower},
    Measure{"camera_rpe_t_rmse_m", "/final/camera/rpe_t_m/rmse", "", kLower},
    Measure{"camera_rpe_t_median_m", "/final/camera/rpe_t_m/median", "", kLower},
    Measure{"camera_rpe_r_rmse_deg", "/final/camera/rpe_r_deg/rmse", "", kLower},
    Measure{"camera_rpe_r_median_deg", "/final/camera/rpe_r_deg/median", "", kLower},
    Measure{"camera_kitti_t_percent", "/final/camera/kitti/translation_percent", "", kLower},
    Measure{"online_camera_kitti_t_percent", "/online/camera/kitti/translation_percent", "", kLower},
    Measure{"camera_kitti_r_deg_per_m", "/final/camera/kitti/rotation_deg_per_m", "", kLower},
    Measure{"online_camera_kitti_r_deg_per_m", "/online/camera/kitti/rotation_deg_per_m", "", kLower},
    Measure{"camera_kitti_segments", "/final/camera/kitti/segments", "", kNeither},
    Measure{"camera_kitti_shortest_m", "/final/camera/kitti/by_length/0/length_m", "", kNeither},
    Measure{"truth_way_difference_percent", "/truth/velocity_check/difference_percent", "", kNeither},
    Measure{"camera_path_m", "/final/camera/path_length_m", "", kNeither},
    Measure{"camera_mounted_ate_m", "/final/camera_mounted/ate_m/rmse", "", kLower},
    Measure{"camera_mounted_end_error_percent", "/final/camera_mounted/end_error_percent", "", kLower},
    Measure{"camera_mounted_rpe_t_rmse_m", "/final/camera_mounted/rpe_t_m/rmse", "", kLower},
    Measure{"baseline_ate_m", "/baseline/camera/ate_baseline_m", "", kNeither},
    Measure{"me_t_m", "/final/motion/me_t_m/mean", "/final/motion/me_t_m/count", kLower},
    Measure{"online_me_t_m", "/online/motion/me_t_m/mean", "/online/motion/me_t_m/count", kLower},
    Measure{"me_r_deg", "/final/motion/me_r_deg/mean", "/final/motion/me_r_deg/count", kLower},
    Measure{"online_me_r_deg", "/online/motion/me_r_deg/mean", "/online/motion/me_r_deg/count", kLower},
    Measure{"me_t_object_rms_m", "/final/followed_motion/me_t_object_rms_m", "/final/followed_motion/objects", kLower},
    Measure{"online_me_t_object_rms_m", "/online/followed_motion/me_t_object_rms_m", "/online/followed_motion/objects",
            kLower},
    Measure{"me_t_followed_mean_m", "/final/followed_motion/me_t_m/mean", "/final/followed_motion/objects", kLower},
    Measure{"online_me_t_followed_mean_m", "/online/followed_motion/me_t_m/mean", "/online/followed_motion/objects",
            kLower},
    Measure{"me_t_followed_median_m", "/final/followed_motion/me_t_m/median", "/final/followed_motion/objects", kLower},
    Measure{"online_me_t_followed_median_m", "/online/followed_motion/me_t_m/median", "/online/followed_motion/objects",
            kLower},
    Measure{"me_t_followed_p95_m", "/final/followed_motion/me_t_m/p95", "/final/followed_motion/objects", kLower},
    Measure{"online_me_t_followed_p95_m", "/online/followed_motion/me_t_m/p95", "/online/followed_motion/objects",
            kLower},
    Measure{"me_t_followed_max_m", "/final/followed_motion/me_t_m/max", "/final/followed_motion/objects", kLower},
    Measure{"online_me_t_followed_max_m", "/online/followed_motion/me_t_m/max", "/online/followed_motion/objects",
            kLower},
    Measure{"me_r_object_rms_deg", "/final/followed_motion/me_r_object_rms_deg", "/final/followed_motion/objects",
            kLower},
    Measure{"online_me_r_object_rms_deg", "/online/followed_motion/me_r_object_rms_deg",
            "/online/followed_motion/objects", kLower},
    Measure{"me_r_followed_mean_deg", "/final/followed_motion/me_r_deg/mean", "/final/followed_motion/objects", kLower},
    Measure{"online_me_r_followed_mean_deg", "/online/followed_motion/me_r_deg/mean", "/online/followed_motion/objects",
            kLower},
    Measure{"me_r_followed_median_deg", "/final/followed_motion/me_r_deg/median", "/final/followed_motion/objects",
            kLower},
    Measure{"online_me_r_followed_median_deg", "/online/followed_motion/me_r_deg/median",
            "/online/followed_motion/objects", kLower},
    Measure{"me_r_followed_p95_deg", "/final/followed_motion/me_r_deg/p95", "/final/followed_motion/objects", kLower},
    Measure{"online_me_r_followed_p95_deg", "/online/followed_motion/me_r_deg/p95", "/online/followed_motion/objects",
            kLower},
    Measure{"me_r_followed_max_deg", "/final/followed_motion/me_r_deg/max", "/final/followed_motion/objects", kLower},
    Measure{"online_me_r_followed_max_deg", "/online/followed_motion/me_r_deg/max", "/online/followed_motion/objects",
            kLower},
    Measure{"speed_error_mps", "/final/motion/speed_error_mps/mean", "/final/motion/speed_error_mps/count", kLower},
    Measure{"online_speed_error_mps", "/online/motion/speed_error_mps/mean", "/online/motion/speed_error_mps/count",
            kLower},
    Measure{"acceleration_rmse_mps2", "/final/acceleration/along_mps2/error/rmse",
            "/final/acceleration/along_mps2/error/count", kLower},
    Measure{"acceleration_coverage", "/final/acceleration/along_mps2/coverage_95",
            "/final/acceleration/along_mps2/error/count", kNeither},
    Measure{"yaw_acceleration_rmse_radps2", "/final/acceleration/yaw_radps2/error/rmse",
            "/final/acceleration/yaw_radps2/error/count", kLower},
    Measure{"yaw_acceleration_coverage", "/final/acceleration/yaw_radps2/coverage_95",
            "/final/acceleration/yaw_radps2/error/count", kNeither},
    Measure{"online_acceleration_rmse_mps2", "/online/acceleration/along_mps2/error/rmse",
            "/online/acceleration/along_mps2/error/count", kLower},
    Measure{"online_acceleration_coverage", "/online/acceleration/along_mps2/coverage_95",
            "/online/acceleration/along_mps2/error/count", kNeither},
    Measure{"online_yaw_acceleration_rmse_radps2", "/online/acceleration/yaw_radps2/error/rmse",
            "/online/acceleration/yaw_radps2/error/count", kLower},
    Measure{"online_yaw_acceleration_coverage", "/online/acceleration/yaw_radps2/coverage_95",
            "/online/acceleration/yaw_radps2/error/count", kNeither},
    Measure{"labels_30m", "/final/detection/within_30m/labels", "", kNeither},
    Measure{"found_30m", "/final/detection/within_30m/found", "", kNeither},
    Measure{"labels_30_to_50m", "/final/detection/from_30_to_50m/labels", "", kNeither},
    Measure{"found_30_to_50m", "/final/detection/from_30_to_50m/found", "", kNeither},
    Measure{"recall_30m", "", "", kHigher},
    Measure{"recall_30_to_50m", "", "", kHigher},
    Measure{"rows", "/final/detection/rows", "", kNeither},
    Measure{"false_rows", "/final/detection/false_rows", "", kLower},
    Measure{"id_switches", "/final/detection/id_switches", "", kLower},
    Measure{"mota", "/final/detection/mota", "/final/detection/within_30m/labels", kHigher},
    Measure{"existence_brier", "/final/existence/brier", "/final/existence/rows", kLower},
    Measure{"online_existence_brier", "/online/existence/brier", "/online/existence/rows", kLower},
    Measure{"objects", "/final/objects_mean/objects", "", kNeither},
    Measure{"objects_aligned_m", "/final/objects_mean/ate_rmse_m/aligned", "/final/objects_mean/objects", kLower},
    Measure{"objects_offset_removed_m", "/final/objects_mean/ate_rmse_m/world_offset_removed",
            "/final/objects_mean/objects", kLower},
    Measure{"objects_as_seen_m", "/final/objects_mean/ate_rmse_m/as_seen_offset_removed", "/final/objects_mean/objects",
            kLower},
    Measure{"objects_are_deg", "/final/objects_mean/are_rmse_deg", "/final/objects_mean/objects", kLower},
    Measure{"origin_drift_along_m", "/final/objects_mean/largest_origin_drift_m/0", "", kNeither},
    Measure{"origin_drift_up_m", "/final/objects_mean/largest_origin_drift_m/1", "", kNeither},
    Measure{"origin_drift_across_m", "/final/objects_mean/largest_origin_drift_m/2", "", kNeither},
    Measure{"re_aligned", "", "", kHigher},
    Measure{"re_offset_removed", "", "", kHigher},
    Measure{"re_as_seen", "", "", kHigher},
    Measure{"box_iou_2d", "/final/boxes_within_30m/iou_2d", "/final/boxes_within_30m/rows", kHigher},
    Measure{"online_box_iou_2d", "/online/boxes_within_30m/iou_2d", "/online/boxes_within_30m/rows", kHigher},
    Measure{"box_over_half_2d", "/final/boxes_within_30m/over_half_2d", "/final/boxes_within_30m/rows", kHigher},
    Measure{"box_iou_bird", "/final/boxes_within_30m/iou_bird", "/final/boxes_within_30m/rows", kHigher},
    Measure{"online_box_iou_bird", "/online/boxes_within_30m/iou_bird", "/online/boxes_within_30m/rows", kHigher},
    Measure{"box_iou_3d", "/final/boxes_within_30m/iou_3d", "/final/boxes_within_30m/rows", kHigher},
    Measure{"box_center_m", "/final/boxes_within_30m/center_m/mean", "/final/boxes_within_30m/rows_with_cuboid",
            kLower},
    Measure{"box_heading_deg", "/final/boxes_within_30m/heading_deg/mean", "/final/boxes_within_30m/rows_with_cuboid",
            kLower},
    Measure{"box_length_m", "/final/boxes_within_30m/length_m/mean", "/final/boxes_within_30m/rows_with_cuboid",
            kLower},
    Measure{"box_width_m", "/final/boxes_within_30m/width_m/mean", "/final/boxes_within_30m/rows_with_cuboid", kLower},
    Measure{"box_height_m", "/final/boxes_within_30m/height_m/mean", "/final/boxes_within_30m/rows_with_cuboid",
            kLower},
    Measure{"box_length_in_2_sigma", "/final/boxes_within_30m/length_within_2_sigma",
            "/final/boxes_within_30m/rows_with_cuboid", kNeither},
    Measure{"box_width_in_2_sigma", "/final/boxes_within_30m/width_within_2_sigma",
            "/final/boxes_within_30m/rows_with_cuboid", kNeither},
    Measure{"box_height_in_2_sigma", "/final/boxes_within_30m/height_within_2_sigma",
            "/final/boxes_within_30m/rows_with_cuboid", kNeither},
    Measure{"hota", "/final/hota/image/within_30m/hota", "/final/hota/image/within_30m/labels", kHigher},
    Measure{"online_hota", "/online/hota/image/within_30m/hota", "/online/hota/image/within_30m/labels", kHigher},
    Measure{"det_a", "/final/hota/image/within_30m/det_a", "/final/hota/image/within_30m/labels", kHigher},
    Measure{"ass_a", "/final/hota/image/within_30m/ass_a", "/final/hota/image/within_30m/labels", kHigher},
    Measure{"loc_a", "/final/hota/image/within_30m/loc_a", "/final/hota/image/within_30m/labels", kHigher},
    Measure{"hota_50m", "/final/hota/image/within_50m/hota", "/final/hota/image/within_50m/labels", kHigher},
    Measure{"hota_above", "/final/hota/footprint/within_30m/hota", "/final/hota/footprint/within_30m/labels", kHigher},
    Measure{"online_hota_above", "/online/hota/footprint/within_30m/hota", "/online/hota/footprint/within_30m/labels",
            kHigher},
    Measure{"mask_iou", "/masks/within_30m/iou", "/masks/within_30m/rows", kHigher},
    Measure{"mask_iou_30_to_50m", "/masks/from_30_to_50m/iou", "/masks/from_30_to_50m/rows", kHigher},
    Measure{"mask_boundary_px", "/masks/within_30m/boundary_px/mean", "/masks/within_30m/boundary_px/count", kLower},
    Measure{"kinds_right", "/final/kinds_within_30m/from_tenth_row/right",
            "/final/kinds_within_30m/from_tenth_row/rows", kHigher},
    Measure{"online_kinds_right", "/online/kinds_within_30m/from_tenth_row/right",
            "/online/kinds_within_30m/from_tenth_row/rows", kHigher},
    Measure{"kinds_log_loss", "/final/kinds_within_30m/from_tenth_row/log_loss",
            "/final/kinds_within_30m/from_tenth_row/rows", kLower},
    Measure{"online_kinds_log_loss", "/online/kinds_within_30m/from_tenth_row/log_loss",
            "/online/kinds_within_30m/from_tenth_row/rows", kLower},
    Measure{"kinds_sure_wrong", "/final/kinds_within_30m/from_tenth_row/sure_wrong",
            "/final/kinds_within_30m/from_tenth_row/rows", kLower},
    Measure{"online_kinds_sure_wrong", "/online/kinds_within_30m/from_tenth_row/sure_wrong",
            "/online/kinds_within_30m/from_tenth_row/rows", kLower},
    Measure{"first_report_median_frames", "/online/first_report/within_30m/frames/median",
            "/online/first_report/within_30m/frames/count", kLower},
    Measure{"first_report_mean_frames", "/online/first_report/within_30m/frames/mean",
            "/online/first_report/within_30m/frames/count", kLower},
    Measure{"never_reported", "/online/first_report/within_30m/never", "", kLower},
    Measure{"first_report_50m_median_frames", "/online/first_report/within_50m/frames/median",
            "/online/first_report/within_50m/frames/count", kLower},
    Measure{"first_report_50m_mean_frames", "/online/first_report/within_50m/frames/mean",
            "/online/first_report/within_50m/frames/count", kLower},
    Measure{"never_reported_50m", "/online/first_report/within_50m/never", "", kLower},
    Measure{"camera_nees", "/covariance/camera/mean_nees", "/covariance/camera/samples", kNeither},
    Measure{"camera_coverage", "/covariance/camera/coverage_95", "/covariance/camera/samples", kNeither},
    Measure{"camera_rotation_coverage", "/covariance/camera/rotation/coverage_95", "/covariance/camera/samples",
            kNeither},
    Measure{"objects_nees", "/covariance/objects/mean_nees", "/covariance/objects/samples", kNeither},
    Measure{"objects_coverage", "/covariance/objects/coverage_95", "/covariance/objects/samples", kNeither},
    Measure{"latency_p50_ms", "summary:/latency_ms/p50", "summary:/latency_ms/count", kLower},
    Measure{"latency_p95_ms", "summary:/latency_ms/p95", "summary:/latency_ms/count", kLower},
    Measure{"latency_p99_ms", "summary:/latency_ms/p99", "summary:/latency_ms/count", kLower},
    Measure{"latency_max_ms", "summary:/latency_ms/max", "summary:/latency_ms/count", kLower},
    Measure{"cpu_per_frame_ms", "", "", kLower},
    Measure{"throughput_hz", "summary:/throughput_hz", "", kHigher},
    Measure{"peak_memory_mb", "", "", kLower},
    Measure{"tracked_fraction", "summary:/frames/tracked_fraction", "", kHigher},
    Measure{"lost", "summary:/frames/lost", "", kLower},
    Measure{"dropped", "summary:/frames/dropped", "", kNeither},
    Measure{"rejected", "summary:/frames/rejected", "", kNeither},
    Measure{"wall_s", "summary:/wall_s", "", kNeither},
    Measure{"cpu_s", "summary:/cpu_s", "", kNeither},
};

constexpr std::string_view kOfSummary = "summary:";

double numberAt(const nlohmann::json& json, std::string_view path) {
  const nlohmann::json::json_pointer pointer{std::string(path)};
  if (json.is_null() || !json.contains(pointer)) return kNoValue;
  const auto& value = json.at(pointer);
  return value.is_number() ? value.get<double>() : kNoValue;
}

/// Takes the consistency measures of a real drive without the truth's mounting error, where they exist.
void preferMounted(MeasureValues& values, const nlohmann::json& evaluation) {
  struct Other {
    std::string_view name, part, path;
  };
  constexpr std::array kOthers{
      Other{"camera_nees", "/covariance/camera_mounted", "/mean_nees"},
      Other{"camera_coverage", "/covariance/camera_mounted", "/coverage_95"},
      Other{"camera_rotation_coverage", "/covariance/camera_mounted_with_truth_noise", "/rotation/coverage_95"}};
  for (const Other& other : kOthers) {
    const std::string part(other.part);
    const double samples = numberAt(evaluation, part + "/samples");
    if (std::isnan(samples)) continue;
    values[measureIndex(other.name)] = samples > 0 ? numberAt(evaluation, part + std::string(other.path)) : kNoValue;
  }
}

}  // namespace

std::span<const Measure> allMeasures() { return kMeasures; }

std::size_t measureIndex(std::string_view name) {
  const auto found = std::ranges::find(kMeasures, name, &Measure::name);
  if (found == kMeasures.end()) throw std::logic_error("there is no measure " + std::string(name));
  return static_cast<std::size_t>(found - kMeasures.begin());
}

MeasureValues measuresOf(const nlohmann::json& evaluation, const nlohmann::json& summary) {
  const auto at = [&](std::string_view path) {
    if (path.empty()) return kNoValue;
    return path.starts_with(kOfSummary) ? numberAt(summary, path.substr(kOfSummary.size()))
                                        : numberAt(evaluation, path);
  };
  MeasureValues values;
  for (const Measure& measure : kMeasures) {
    const bool means_something = measure.guard.empty() || at(measure.guard) > 0;
    values.push_back(means_something ? at(measure.path) : kNoValue);
  }
  preferMounted(values, evaluation);
  for (const std::string_view range : {"30m", "30_to_50m"}) {
    const auto of = [&](std::string_view count) -> double& {
      return values[measureIndex(std::string(count).append("_").append(range))];
    };
    if (of("labels") > 0) of("recall") = of("found") / of("labels");
  }
  constexpr double kMsPerS = 1e3, kBytesPerMb = 1e6;
  const double frames = numberAt(summary, "/frames/received");
  if (frames > 0) values[measureIndex("cpu_per_frame_ms")] = kMsPerS * numberAt(summary, "/cpu_s") / frames;
  values[measureIndex("peak_memory_mb")] = numberAt(summary, "/peak_memory_bytes") / kBytesPerMb;
  return values;
}

}  // namespace motorcade
