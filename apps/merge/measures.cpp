#include "apps/merge/measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

namespace motorcade {
namespace {

constexpr auto kLower = Better::kLower, kHigher = Better::kHigher, kNeither = Better::kNeither;

constexpr auto kMeasures = std::to_array<Measure>({
    {"frames", "", "/frames", "", kNeither},
    {"camera_ate_m", "/final/camera/ate_m", "/rmse", "", kLower},
    {"camera_end_error_percent", "/final/camera", "/end_error_percent", "", kLower},
    {"camera_rpe_t_rmse_m", "/final/camera/rpe_t_m", "/rmse", "", kLower},
    {"camera_rpe_t_median_m", "/final/camera/rpe_t_m", "/median", "", kLower},
    {"camera_rpe_r_rmse_deg", "/final/camera/rpe_r_deg", "/rmse", "", kLower},
    {"camera_rpe_r_median_deg", "/final/camera/rpe_r_deg", "/median", "", kLower},
    {"camera_kitti_t_percent", "/final/camera/kitti", "/translation_percent", "", kLower},
    {"online_camera_kitti_t_percent", "/online/camera/kitti", "/translation_percent", "", kLower},
    {"camera_kitti_r_deg_per_m", "/final/camera/kitti", "/rotation_deg_per_m", "", kLower},
    {"online_camera_kitti_r_deg_per_m", "/online/camera/kitti", "/rotation_deg_per_m", "", kLower},
    {"camera_kitti_segments", "/final/camera/kitti", "/segments", "", kNeither},
    {"camera_kitti_shortest_m", "/final/camera/kitti/by_length/0", "/length_m", "", kNeither},
    {"truth_way_difference_percent", "/truth/velocity_check", "/difference_percent", "", kNeither},
    {"camera_path_m", "/final/camera", "/path_length_m", "", kNeither},
    {"camera_mounted_ate_m", "/final/camera_mounted/ate_m", "/rmse", "", kLower},
    {"camera_mounted_end_error_percent", "/final/camera_mounted", "/end_error_percent", "", kLower},
    {"camera_mounted_rpe_t_rmse_m", "/final/camera_mounted/rpe_t_m", "/rmse", "", kLower},
    {"baseline_ate_m", "/baseline/camera", "/ate_baseline_m", "", kNeither},
    {"me_t_m", "/final/motion/me_t_m", "/mean", "/count", kLower},
    {"online_me_t_m", "/online/motion/me_t_m", "/mean", "/count", kLower},
    {"me_r_deg", "/final/motion/me_r_deg", "/mean", "/count", kLower},
    {"online_me_r_deg", "/online/motion/me_r_deg", "/mean", "/count", kLower},
    {"me_t_object_rms_m", "/final/followed_motion", "/me_t_object_rms_m", "/objects", kLower},
    {"online_me_t_object_rms_m", "/online/followed_motion", "/me_t_object_rms_m", "/objects", kLower},
    {"me_t_followed_mean_m", "/final/followed_motion", "/me_t_m/mean", "/objects", kLower},
    {"online_me_t_followed_mean_m", "/online/followed_motion", "/me_t_m/mean", "/objects", kLower},
    {"me_t_followed_median_m", "/final/followed_motion", "/me_t_m/median", "/objects", kLower},
    {"online_me_t_followed_median_m", "/online/followed_motion", "/me_t_m/median", "/objects", kLower},
    {"me_t_followed_p95_m", "/final/followed_motion", "/me_t_m/p95", "/objects", kLower},
    {"online_me_t_followed_p95_m", "/online/followed_motion", "/me_t_m/p95", "/objects", kLower},
    {"me_t_followed_max_m", "/final/followed_motion", "/me_t_m/max", "/objects", kLower},
    {"online_me_t_followed_max_m", "/online/followed_motion", "/me_t_m/max", "/objects", kLower},
    {"me_r_object_rms_deg", "/final/followed_motion", "/me_r_object_rms_deg", "/objects", kLower},
    {"online_me_r_object_rms_deg", "/online/followed_motion", "/me_r_object_rms_deg", "/objects", kLower},
    {"me_r_followed_mean_deg", "/final/followed_motion", "/me_r_deg/mean", "/objects", kLower},
    {"online_me_r_followed_mean_deg", "/online/followed_motion", "/me_r_deg/mean", "/objects", kLower},
    {"me_r_followed_median_deg", "/final/followed_motion", "/me_r_deg/median", "/objects", kLower},
    {"online_me_r_followed_median_deg", "/online/followed_motion", "/me_r_deg/median", "/objects", kLower},
    {"me_r_followed_p95_deg", "/final/followed_motion", "/me_r_deg/p95", "/objects", kLower},
    {"online_me_r_followed_p95_deg", "/online/followed_motion", "/me_r_deg/p95", "/objects", kLower},
    {"me_r_followed_max_deg", "/final/followed_motion", "/me_r_deg/max", "/objects", kLower},
    {"online_me_r_followed_max_deg", "/online/followed_motion", "/me_r_deg/max", "/objects", kLower},
    {"speed_error_mps", "/final/motion/speed_error_mps", "/mean", "/count", kLower},
    {"online_speed_error_mps", "/online/motion/speed_error_mps", "/mean", "/count", kLower},
    {"acceleration_rmse_mps2", "/final/acceleration/along_mps2/error", "/rmse", "/count", kLower},
    {"acceleration_coverage", "/final/acceleration/along_mps2", "/coverage_95", "/error/count", kNeither},
    {"yaw_acceleration_rmse_radps2", "/final/acceleration/yaw_radps2/error", "/rmse", "/count", kLower},
    {"yaw_acceleration_coverage", "/final/acceleration/yaw_radps2", "/coverage_95", "/error/count", kNeither},
    {"online_acceleration_rmse_mps2", "/online/acceleration/along_mps2/error", "/rmse", "/count", kLower},
    {"online_acceleration_coverage", "/online/acceleration/along_mps2", "/coverage_95", "/error/count", kNeither},
    {"online_yaw_acceleration_rmse_radps2", "/online/acceleration/yaw_radps2/error", "/rmse", "/count", kLower},
    {"online_yaw_acceleration_coverage", "/online/acceleration/yaw_radps2", "/coverage_95", "/error/count", kNeither},
    {"labels_30m", "/final/detection/within_30m", "/labels", "", kNeither},
    {"found_30m", "/final/detection/within_30m", "/found", "", kNeither},
    {"labels_30_to_50m", "/final/detection/from_30_to_50m", "/labels", "", kNeither},
    {"found_30_to_50m", "/final/detection/from_30_to_50m", "/found", "", kNeither},
    {"recall_30m", "", "", "", kHigher},
    {"recall_30_to_50m", "", "", "", kHigher},
    {"rows", "/final/detection", "/rows", "", kNeither},
    {"false_rows", "/final/detection", "/false_rows", "", kLower},
    {"id_switches", "/final/detection", "/id_switches", "", kLower},
    {"mota", "/final/detection", "/mota", "/within_30m/labels", kHigher},
    {"existence_brier", "/final/existence", "/brier", "/rows", kLower},
    {"online_existence_brier", "/online/existence", "/brier", "/rows", kLower},
    {"objects", "/final/objects_mean", "/objects", "", kNeither},
    {"objects_aligned_m", "/final/objects_mean", "/ate_rmse_m/aligned", "/objects", kLower},
    {"objects_offset_removed_m", "/final/objects_mean", "/ate_rmse_m/world_offset_removed", "/objects", kLower},
    {"objects_as_seen_m", "/final/objects_mean", "/ate_rmse_m/as_seen_offset_removed", "/objects", kLower},
    {"objects_are_deg", "/final/objects_mean", "/are_rmse_deg", "/objects", kLower},
    {"origin_drift_along_m", "/final/objects_mean/largest_origin_drift_m", "/0", "", kNeither},
    {"origin_drift_up_m", "/final/objects_mean/largest_origin_drift_m", "/1", "", kNeither},
    {"origin_drift_across_m", "/final/objects_mean/largest_origin_drift_m", "/2", "", kNeither},
    {"re_aligned", "", "", "", kHigher},
    {"re_offset_removed", "", "", "", kHigher},
    {"re_as_seen", "", "", "", kHigher},
    {"box_iou_2d", "/final/boxes_within_30m", "/iou_2d", "/rows", kHigher},
    {"online_box_iou_2d", "/online/boxes_within_30m", "/iou_2d", "/rows", kHigher},
    {"box_over_half_2d", "/final/boxes_within_30m", "/over_half_2d", "/rows", kHigher},
    {"box_iou_bird", "/final/boxes_within_30m", "/iou_bird", "/rows", kHigher},
    {"online_box_iou_bird", "/online/boxes_within_30m", "/iou_bird", "/rows", kHigher},
    {"box_iou_3d", "/final/boxes_within_30m", "/iou_3d", "/rows", kHigher},
    {"box_center_m", "/final/boxes_within_30m", "/center_m/mean", "/rows_with_cuboid", kLower},
    {"box_heading_deg", "/final/boxes_within_30m", "/heading_deg/mean", "/rows_with_cuboid", kLower},
    {"box_length_m", "/final/boxes_within_30m", "/length_m/mean", "/rows_with_cuboid", kLower},
    {"box_width_m", "/final/boxes_within_30m", "/width_m/mean", "/rows_with_cuboid", kLower},
    {"box_height_m", "/final/boxes_within_30m", "/height_m/mean", "/rows_with_cuboid", kLower},
    {"box_length_in_2_sigma", "/final/boxes_within_30m", "/length_within_2_sigma", "/rows_with_cuboid", kNeither},
    {"box_width_in_2_sigma", "/final/boxes_within_30m", "/width_within_2_sigma", "/rows_with_cuboid", kNeither},
    {"box_height_in_2_sigma", "/final/boxes_within_30m", "/height_within_2_sigma", "/rows_with_cuboid", kNeither},
    {"hota", "/final/hota/image/within_30m", "/hota", "/labels", kHigher},
    {"online_hota", "/online/hota/image/within_30m", "/hota", "/labels", kHigher},
    {"det_a", "/final/hota/image/within_30m", "/det_a", "/labels", kHigher},
    {"ass_a", "/final/hota/image/within_30m", "/ass_a", "/labels", kHigher},
    {"loc_a", "/final/hota/image/within_30m", "/loc_a", "/labels", kHigher},
    {"hota_50m", "/final/hota/image/within_50m", "/hota", "/labels", kHigher},
    {"hota_above", "/final/hota/footprint/within_30m", "/hota", "/labels", kHigher},
    {"online_hota_above", "/online/hota/footprint/within_30m", "/hota", "/labels", kHigher},
    {"mask_iou", "/masks/within_30m", "/iou", "/rows", kHigher},
    {"mask_iou_30_to_50m", "/masks/from_30_to_50m", "/iou", "/rows", kHigher},
    {"mask_boundary_px", "/masks/within_30m/boundary_px", "/mean", "/count", kLower},
    {"kinds_right", "/final/kinds_within_30m/from_tenth_row", "/right", "/rows", kHigher},
    {"online_kinds_right", "/online/kinds_within_30m/from_tenth_row", "/right", "/rows", kHigher},
    {"kinds_log_loss", "/final/kinds_within_30m/from_tenth_row", "/log_loss", "/rows", kLower},
    {"online_kinds_log_loss", "/online/kinds_within_30m/from_tenth_row", "/log_loss", "/rows", kLower},
    {"kinds_sure_wrong", "/final/kinds_within_30m/from_tenth_row", "/sure_wrong", "/rows", kLower},
    {"online_kinds_sure_wrong", "/online/kinds_within_30m/from_tenth_row", "/sure_wrong", "/rows", kLower},
    {"first_report_median_frames", "/online/first_report/within_30m/frames", "/median", "/count", kLower},
    {"first_report_mean_frames", "/online/first_report/within_30m/frames", "/mean", "/count", kLower},
    {"never_reported", "/online/first_report/within_30m", "/never", "", kLower},
    {"first_report_50m_median_frames", "/online/first_report/within_50m/frames", "/median", "/count", kLower},
    {"first_report_50m_mean_frames", "/online/first_report/within_50m/frames", "/mean", "/count", kLower},
    {"never_reported_50m", "/online/first_report/within_50m", "/never", "", kLower},
    {"camera_nees", "/covariance/camera", "/mean_nees", "/samples", kNeither},
    {"camera_coverage", "/covariance/camera", "/coverage_95", "/samples", kNeither},
    {"camera_rotation_coverage", "/covariance/camera", "/rotation/coverage_95", "/samples", kNeither},
    {"objects_nees", "/covariance/objects", "/mean_nees", "/samples", kNeither},
    {"objects_coverage", "/covariance/objects", "/coverage_95", "/samples", kNeither},
    {"latency_p50_ms", "summary:/latency_ms", "/p50", "/count", kLower},
    {"latency_p95_ms", "summary:/latency_ms", "/p95", "/count", kLower},
    {"latency_p99_ms", "summary:/latency_ms", "/p99", "/count", kLower},
    {"latency_max_ms", "summary:/latency_ms", "/max", "/count", kLower},
    {"cpu_per_frame_ms", "", "", "", kLower},
    {"throughput_hz", "summary:", "/throughput_hz", "", kHigher},
    {"peak_memory_mb", "", "", "", kLower},
    {"tracked_fraction", "summary:/frames", "/tracked_fraction", "", kHigher},
    {"lost", "summary:/frames", "/lost", "", kLower},
    {"dropped", "summary:/frames", "/dropped", "", kNeither},
    {"rejected", "summary:/frames", "/rejected", "", kNeither},
    {"wall_s", "summary:", "/wall_s", "", kNeither},
    {"cpu_s", "summary:", "/cpu_s", "", kNeither},
});

constexpr std::string_view kOfSummary = "summary:";

double numberAt(const nlohmann::json& json, const std::string& path) {
  const nlohmann::json::json_pointer pointer(path);
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

using Entry = std::pair<std::string_view, std::string_view>;

/// Endings of keys and the units that they stand for.
constexpr auto kUnits = std::to_array<Entry>({{"_deg_per_m", "deg/m"},
                                              {"_percent", "%"},
                                              {"_radps2", "rad/s2"},
                                              {"_mps2", "m/s2"},
                                              {"_mps", "m/s"},
                                              {"_deg", "deg"},
                                              {"_px", "px"},
                                              {"_ms", "ms"},
                                              {"_hz", "Hz"},
                                              {"_mb", "MB"},
                                              {"_m", "m"},
                                              {"_s", "s"},
                                              {"_frames", "frames"}});

/// Parts of keys and their meanings; longer parts come first.
constexpr auto kParts =
    std::to_array<Entry>({{"first_report", "frames until first reported"},
                          {"origin_drift", "drift of the origin"},
                          {"offset_removed", "offset removed"},
                          {"30_to_50m", "from 30 to 50 m"},
                          {"as_seen", "as seen from the camera"},
                          {"iou_bird", "IoU from above"},
                          {"hota_above", "HOTA from above"},
                          {"id_switches", "switches of identity"},
                          {"false_rows", "false rows"},
                          {"over_half", "share of IoU over 0.5"},
                          {"end_error", "error at the end"},
                          {"kinds_right", "kinds right"},
                          {"kinds_log_loss", "log loss of kinds"},
                          {"kinds_sure_wrong", "kinds wrong and sure"},
                          {"box_length_in_2_sigma", "share of lengths within two standard deviations"},
                          {"box_width_in_2_sigma", "share of widths within two standard deviations"},
                          {"box_height_in_2_sigma", "share of heights within two standard deviations"},
                          {"box_heading", "error of boxes' heading"},
                          {"box_center", "error of boxes' center"},
                          {"box_length", "error of boxes' length"},
                          {"box_height", "error of boxes' height"},
                          {"box_width", "error of boxes' width"},
                          {"mask_boundary", "distance of masks' boundaries"},
                          {"peak_memory", "most memory"},
                          {"throughput", "pairs per second"},
                          {"existence_brier", "Brier score of existence"},
                          {"tracked_fraction", "share of frames tracked"},
                          {"per_frame", "per pair"},
                          {"never_reported", "movers never reported"},
                          {"mounted", "without the truth's mounting"},
                          {"rpe_t", "RPE of translation"},
                          {"rpe_r", "RPE of rotation"},
                          {"me_t", "motion error of objects, translation"},
                          {"me_r", "motion error of objects, rotation"},
                          {"det_a", "DetA"},
                          {"ass_a", "AssA"},
                          {"loc_a", "LocA"},
                          {"re", "relative improvement on the baseline"},
                          {"path", "length of the path"},
                          {"wall", "wall time"},
                          {"30m", "to 30 m"},
                          {"50m", "to 50 m"},
                          {"hota", "HOTA"},
                          {"mota", "MOTA"},
                          {"nees", "NEES"},
                          {"rmse", "RMSE"},
                          {"rms", "RMS"},
                          {"kitti", "KITTI"},
                          {"iou", "IoU"},
                          {"ate", "ATE"},
                          {"are", "ARE"},
                          {"cpu", "CPU"},
                          {"p50", "median"},
                          {"p95", "95th percentile"},
                          {"p99", "99th percentile"},
                          {"max", "largest"},
                          {"2d", "in the image"},
                          {"3d", "in 3D"}});

/// Tells whether a comma follows the part in a name: it does after a statistic and after a range of distances.
bool closesName(std::string_view part) {
  constexpr std::array<std::string_view, 10> kSummaries{
      "RMSE",    "RMS",     "median",  "mean",           "95th percentile", "99th percentile",
      "largest", "to 30 m", "to 50 m", "from 30 to 50 m"};
  return std::ranges::find(kSummaries, part) != std::end(kSummaries);
}

/// Cuts the first part off; an unknown word stands for itself.
std::string_view takePart(std::string_view& key) {
  for (const auto& [part, meaning] : kParts) {
    if (!key.starts_with(part) || (key.size() > part.size() && key[part.size()] != '_')) continue;
    key.remove_prefix(std::min(key.size(), part.size() + 1));
    return meaning;
  }
  const std::string_view word = key.substr(0, key.find('_'));
  key.remove_prefix(std::min(key.size(), word.size() + 1));
  return word;
}

}  // namespace

std::span<const Measure> allMeasures() { return kMeasures; }

std::size_t measureIndex(std::string_view name) {
  const auto found = std::ranges::find(kMeasures, name, &Measure::name);
  if (found == kMeasures.end()) throw std::logic_error("there is no measure " + std::string(name));
  return static_cast<std::size_t>(found - kMeasures.begin());
}

MeasureValues measuresOf(const nlohmann::json& evaluation, const nlohmann::json& summary) {
  const auto at = [&](std::string_view part, std::string_view path) {
    const bool of_summary = part.starts_with(kOfSummary);
    const std::string pointer = std::string(part.substr(of_summary ? kOfSummary.size() : 0)).append(path);
    return pointer.empty() ? kNoValue : numberAt(of_summary ? summary : evaluation, pointer);
  };
  MeasureValues values;
  for (const Measure& measure : kMeasures) {
    const bool means_something = measure.count.empty() || at(measure.part, measure.count) > 0;
    values.push_back(means_something ? at(measure.part, measure.value) : kNoValue);
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

std::string readableName(std::string_view measure) {
  std::string_view key = measure, unit;
  for (const auto& [end, name] : kUnits)
    if (unit.empty() && key.ends_with(end)) {
      unit = name;
      key.remove_suffix(end.size());
    }
  const bool online = key.starts_with("online_");
  if (online) key.remove_prefix(std::string_view("online_").size());
  std::string name;
  while (!key.empty()) {
    const std::string_view part = takePart(key);
    if (!name.empty()) name += closesName(part) ? ", " : " ";
    name += part;
  }
  if (online) name += ", online";
  return unit.empty() ? name : name.append(" [").append(unit).append("]");
}

}  // namespace motorcade
