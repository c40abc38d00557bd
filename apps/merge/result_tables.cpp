#include "apps/merge/result_tables.hpp"

#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

namespace motorcade {
namespace {

struct Column {
  std::string head;
  std::function<std::string(const ResultGroup&)> cell;
  std::string_view measure{};  // whose mean over the seeds decides which set is better; none when empty
};

/// The mean over the seeds.
Column meanColumn(std::string head, std::string_view measure, int digits, const std::string& behind = "") {
  return {std::move(head), [=](const ResultGroup& group) { return numberText(group.mean(measure), digits) + behind; },
          measure};
}

Column percentColumn(std::string head, std::string_view measure, int digits) {
  return {std::move(head), [=](const ResultGroup& group) { return percentText(group.mean(measure), digits); }, measure};
}

/// Two means, as `final / online`.
Column pairColumn(std::string head, std::string_view first, std::string_view second, int digits) {
  return {std::move(head),
          [=](const ResultGroup& group) {
            return numberText(group.mean(first), digits) + " / " + numberText(group.mean(second), digits);
          },
          first};
}

/// A share of counts that are summed over the seeds.
Column recallColumn(std::string head, std::string_view found, std::string_view labels) {
  return {std::move(head), [=](const ResultGroup& group) {
            const double of = group.sum(labels), are = group.sum(found);
            return of > 0 ? fmt::format("{} ({}/{})", percentText(are / of, 0), numberText(are, 1), numberText(of, 1))
                          : "-";
          }};
}

Column falseRowsColumn() {
  return {"false rows", [](const ResultGroup& group) {
            return numberText(group.sum("false_rows"), 1) + " of " + numberText(group.sum("rows"), 1);
          }};
}

std::string mountedText(const ResultGroup& group) {
  if (std::isnan(group.mean("camera_mounted_ate_m"))) return "-";
  return fmt::format("{}, {} %, {}", numberText(group.mean("camera_mounted_ate_m"), 3),
                     numberText(group.mean("camera_mounted_end_error_percent"), 2),
                     numberText(group.mean("camera_mounted_rpe_t_rmse_m"), 4));
}

/// Means over segments; short drives use the segment lengths that they have.
Column segmentColumn(std::string head, std::string_view measure, std::string_view online, int digits) {
  return {std::move(head), [=](const ResultGroup& group) {
            constexpr double kShortest_m = 100;
            std::string text = numberText(group.mean(measure), digits);
            if (!online.empty()) text += " / " + numberText(group.mean(online), digits);
            return group.smallest("camera_kitti_shortest_m") < kShortest_m ? text + " (10 to 80 m)" : text;
          }};
}

std::string driftText(const ResultGroup& group) {
  return fmt::format("{} / {} / {}", numberText(group.largest("origin_drift_along_m"), 2),
                     numberText(group.largest("origin_drift_up_m"), 2),
                     numberText(group.largest("origin_drift_across_m"), 2));
}

Column firstReportColumn(std::string head, std::string_view median, std::string_view mean, std::string_view never) {
  return {std::move(head), [=](const ResultGroup& group) {
            const double missed = group.sum(never);
            return numberText(group.mean(median), 1) + " / " + numberText(group.mean(mean), 1) +
                   (missed > 0 ? ", " + numberText(missed, 1) + " never" : "");
          }};
}

std::string sizesText(const ResultGroup& group) {
  return percentText(group.mean("box_length_in_2_sigma"), 0) + " / " +
         percentText(group.mean("box_width_in_2_sigma"), 0) + " / " +
         percentText(group.mean("box_height_in_2_sigma"), 0);
}

Column kindsColumn() {
  return {"kinds right final / online", [](const ResultGroup& group) {
            return percentText(group.mean("kinds_right"), 0) + " / " + percentText(group.mean("online_kinds_right"), 0);
          }};
}

Column wrongKindsColumn() {
  return {"wrong and sure final / online", [](const ResultGroup& group) {
            return percentText(group.mean("kinds_sure_wrong"), 1) + " / " +
                   percentText(group.mean("online_kinds_sure_wrong"), 1);
          }};
}

std::vector<Column> cameraColumns() {
  return {
      meanColumn("frames", "frames", 0),
      meanColumn("ATE m", "camera_ate_m", 3),
      meanColumn("end error", "camera_end_error_percent", 2, " %"),
      segmentColumn("KITTI translation % final / online", "camera_kitti_t_percent", "online_camera_kitti_t_percent", 3),
      segmentColumn("KITTI rotation deg/m final / online", "camera_kitti_r_deg_per_m",
                    "online_camera_kitti_r_deg_per_m", 5),
      pairColumn("RPE_t m rmse / median", "camera_rpe_t_rmse_m", "camera_rpe_t_median_m", 4),
      pairColumn("RPE_r deg rmse / median", "camera_rpe_r_rmse_deg", "camera_rpe_r_median_deg", 4),
      {"ATE m, end error, RPE_t m without the truth's mounting", mountedText}};
}

std::vector<Column> objectColumns() {
  return {pairColumn("ME_t m mean, final / online", "me_t_m", "online_me_t_m", 4),
          pairColumn("ME_r deg mean, final / online", "me_r_deg", "online_me_r_deg", 3),
          pairColumn("speed error m/s final / online", "speed_error_mps", "online_speed_error_mps", 2),
          recallColumn("recall to 30 m", "found_30m", "labels_30m"),
          recallColumn("30 to 50 m", "found_30_to_50m", "labels_30_to_50m"),
          falseRowsColumn(),
          pairColumn("Brier score of existence final / online", "existence_brier", "online_existence_brier", 3),
          {"id switches", [](const ResultGroup& group) { return numberText(group.sum("id_switches"), 1); }}};
}

/// Columns of motion errors, the form of published figures first.
std::vector<Column> motionColumns() {
  return {
      pairColumn("ME_t m RMS of each object, mean, final / online", "me_t_object_rms_m", "online_me_t_object_rms_m", 3),
      pairColumn("mean of all steps", "me_t_followed_mean_m", "online_me_t_followed_mean_m", 4),
      pairColumn("median", "me_t_followed_median_m", "online_me_t_followed_median_m", 4),
      pairColumn("95 %", "me_t_followed_p95_m", "online_me_t_followed_p95_m", 3),
      pairColumn("largest", "me_t_followed_max_m", "online_me_t_followed_max_m", 2),
      pairColumn("ME_r deg RMS of each object, mean, final / online", "me_r_object_rms_deg",
                 "online_me_r_object_rms_deg", 3),
      pairColumn("mean of all steps", "me_r_followed_mean_deg", "online_me_r_followed_mean_deg", 3),
      pairColumn("median", "me_r_followed_median_deg", "online_me_r_followed_median_deg", 3),
      pairColumn("95 %", "me_r_followed_p95_deg", "online_me_r_followed_p95_deg", 2),
      pairColumn("largest", "me_r_followed_max_deg", "online_me_r_followed_max_deg", 1)};
}

std::vector<Column> positionColumns() {
  return {{"objects", [](const ResultGroup& group) { return numberText(group.sum("objects"), 1); }},
          meanColumn("ATE m aligned", "objects_aligned_m", 3),
          meanColumn("offset removed", "objects_offset_removed_m", 3),
          meanColumn("as seen, offset removed", "objects_as_seen_m", 3),
          meanColumn("ARE deg", "objects_are_deg", 2),
          percentColumn("RE aligned", "re_aligned", 1),
          percentColumn("RE offset removed", "re_offset_removed", 1),
          percentColumn("RE as seen, offset removed", "re_as_seen", 1),
          {"drift of the origin m along / up / across", driftText}};
}

std::vector<Column> boxColumns() {
  return {pairColumn("IoU in the image final / online", "box_iou_2d", "online_box_iou_2d", 2),
          percentColumn("over .5", "box_over_half_2d", 0),
          pairColumn("IoU from above final / online", "box_iou_bird", "online_box_iou_bird", 2),
          meanColumn("IoU in 3D", "box_iou_3d", 2),
          meanColumn("center m", "box_center_m", 2),
          meanColumn("heading deg", "box_heading_deg", 1),
          meanColumn("length m", "box_length_m", 2),
          meanColumn("width m", "box_width_m", 2),
          meanColumn("height m", "box_height_m", 2),
          {"length / width / height within 2 sigma", sizesText}};
}

std::vector<Column> trackingColumns() {
  return {pairColumn("HOTA in the image final / online", "hota", "online_hota", 2),
          meanColumn("DetA", "det_a", 2),
          meanColumn("AssA", "ass_a", 2),
          meanColumn("LocA", "loc_a", 2),
          meanColumn("to 50 m", "hota_50m", 2),
          pairColumn("HOTA from above final / online", "hota_above", "online_hota_above", 2),
          meanColumn("mask IoU", "mask_iou", 2),
          meanColumn("30 to 50 m", "mask_iou_30_to_50m", 2),
          meanColumn("boundary px", "mask_boundary_px", 1),
          kindsColumn(),
          pairColumn("log loss of kinds final / online", "kinds_log_loss", "online_kinds_log_loss", 3),
          wrongKindsColumn(),
          firstReportColumn("first report, median / mean", "first_report_median_frames", "first_report_mean_frames",
                            "never_reported"),
          firstReportColumn("to 50 m", "first_report_50m_median_frames", "first_report_50m_mean_frames",
                            "never_reported_50m")};
}

std::vector<Column> covarianceColumns() {
  return {meanColumn("camera NEES", "camera_nees", 2), percentColumn("inside 95 %", "camera_coverage", 1),
          percentColumn("rotation over ten frames inside 95 %", "camera_rotation_coverage", 1),
          meanColumn("objects NEES", "objects_nees", 2), percentColumn("inside 95 %", "objects_coverage", 1)};
}

std::vector<Column> latencyColumns() {
  return {meanColumn("latency ms p50", "latency_p50_ms", 1),
          meanColumn("p95", "latency_p95_ms", 1),
          meanColumn("p99", "latency_p99_ms", 1),
          {"max", [](const ResultGroup& group) { return numberText(group.largest("latency_max_ms"), 1); }},
          meanColumn("CPU ms per pair", "cpu_per_frame_ms", 1),
          meanColumn("pairs per second", "throughput_hz", 1),
          meanColumn("memory MB", "peak_memory_mb", 0),
          percentColumn("tracked", "tracked_fraction", 1)};
}

std::string worstText(const WorstFrame& frame, int digits) {
  return frame.task.empty()
             ? "-"
             : fmt::format("{} (frame {} of {})", numberText(frame.value, digits), frame.frame, frame.task);
}

/// Columns of the worst frames of each drive, the first to look at.
std::vector<Column> worstColumns() {
  return {{"RPE_t m", [](const ResultGroup& group) { return worstText(group.worst().camera_m, 3); }},
          {"ME_t m", [](const ResultGroup& group) { return worstText(group.worst().object_m, 3); }},
          {"latency ms", [](const ResultGroup& group) { return worstText(group.worst().latest_ms, 1); }}};
}

/// Marks the best set by each measure and the worst among one drive's results, which are in adjacent rows. Marks only
/// differences that are large enough to tell.
void markSets(ResultTable& table, const std::vector<const ResultGroup*>& groups, const std::vector<Column>& columns) {
  constexpr double kWorthMarking = 0.02;  // of the mean of both
  for (std::size_t begin = 0, end = 0; begin < groups.size(); begin = end) {
    while (end < groups.size() && groups[end]->drive() == groups[begin]->drive()) ++end;
    for (std::size_t column = 0; column < columns.size(); ++column) {
      if (columns[column].measure.empty()) continue;
      const Better better = allMeasures()[measureIndex(columns[column].measure)].better;
      const auto value = [&](std::size_t row) { return groups[row]->mean(columns[column].measure); };
      std::size_t low = begin, high = begin;
      for (std::size_t row = begin; row < end; ++row) {
        if (std::isnan(value(low)) || value(row) < value(low)) low = row;
        if (std::isnan(value(high)) || value(row) > value(high)) high = row;
      }
      const double apart = value(high) - value(low);
      if (better == Better::kNeither || !(apart > kWorthMarking * std::abs(value(high) + value(low)) / 2)) continue;
      table.tones[low][table.names + column] = better == Better::kLower ? Tone::kBetter : Tone::kWorse;
      table.tones[high][table.names + column] = better == Better::kLower ? Tone::kWorse : Tone::kBetter;
    }
  }
}

enum class Labels { kNeeded, kNotNeeded };

ResultTable tableOf(std::string title, const std::vector<ResultGroup>& groups, const std::vector<Column>& columns,
                    Labels labels) {
  ResultTable table{.title = std::move(title), .heads = {"drive"}};
  const bool with_sets = setsIn(groups) > 1;
  if (with_sets) table.heads.emplace_back("set");
  table.names = table.heads.size();
  for (const Column& column : columns) table.heads.push_back(column.head);
  std::vector<const ResultGroup*> shown;
  for (const ResultGroup& group : groups) {
    if (labels == Labels::kNeeded && !group.hasLabels()) continue;
    std::vector<std::string> row{group.drive()};
    if (with_sets) row.push_back(group.set());
    for (const Column& column : columns) row.push_back(column.cell(group));
    table.tones.emplace_back(row.size(), Tone::kNone);
    table.rows.push_back(std::move(row));
    shown.push_back(&group);
  }
  if (with_sets) markSets(table, shown, columns);
  return table;
}

}  // namespace

ResultTable overviewTable(const std::vector<ResultGroup>& groups) {
  const std::vector<Column> columns{
      meanColumn("camera ATE m", "camera_ate_m", 3),
      meanColumn("of the baseline", "baseline_ate_m", 3),
      segmentColumn("KITTI translation %", "camera_kitti_t_percent", "", 2),
      meanColumn("objects m", "objects_as_seen_m", 3),
      meanColumn("motion of objects per frame m, mean", "me_t_m", 4),
      meanColumn("RMS of each, mean", "me_t_object_rms_m", 3),
      recallColumn("recall to 30 m", "found_30m", "labels_30m"),
      {"false rows", [](const ResultGroup& group) { return group.hasLabels() ? falseRowsColumn().cell(group) : "-"; }}};
  return tableOf("Overview", groups, columns, Labels::kNotNeeded);
}

std::vector<ResultTable> measureTables(const std::vector<ResultGroup>& groups) {
  std::vector<ResultTable> tables{
      tableOf("Camera", groups, cameraColumns(), Labels::kNotNeeded),
      tableOf("Objects", groups, objectColumns(), Labels::kNeeded),
      tableOf("Motion of all followed objects per frame", groups, motionColumns(), Labels::kNeeded),
      tableOf("Positions of objects", groups, positionColumns(), Labels::kNeeded),
      tableOf("Boxes of objects within 30 m", groups, boxColumns(), Labels::kNeeded),
      tableOf("Tracking within 30 m", groups, trackingColumns(), Labels::kNeeded),
      tableOf("Covariances", groups, covarianceColumns(), Labels::kNotNeeded),
      tableOf("Latency and cost", groups, latencyColumns(), Labels::kNotNeeded),
      tableOf("Worst frame of each drive", groups, worstColumns(), Labels::kNotNeeded)};
  std::erase_if(tables, [](const ResultTable& table) { return table.rows.empty(); });
  return tables;
}

std::string numberText(double value, int digits) {
  if (std::isnan(value)) return "-";
  const double scale = std::pow(10, digits);
  const double rounded = std::round(value * scale) / scale;
  return fmt::format("{}", rounded == 0 ? 0.0 : rounded);
}

std::string percentText(double share, int digits) {
  constexpr double kPercent = 100;
  return std::isnan(share) ? "-" : numberText(kPercent * share, digits) + " %";
}

}  // namespace motorcade
