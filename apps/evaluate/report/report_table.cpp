#include "apps/evaluate/report/report.hpp"
#include "io/results/object_row.hpp"

namespace motorcade {
namespace {

void printPosition(std::string& text, const ObjectErrors& object) {
  print(text, "  {:<6} {:<14.14} {:5}/{:<5} {:3}", object.label, object.type, object.followed_frames,
        object.labeled_frames, object.tracks);
  if (!object.positions) return print(text, "\n");
  const PositionErrors& p = *object.positions;
  print(text, "  {:7.3f} {:7.3f} {:7.3f}  {:6.2f}", p.of(PositionKind::kAligned).rmse,
        p.of(PositionKind::kWorldOffsetRemoved).rmse, p.of(PositionKind::kAsSeenOffsetRemoved).rmse, p.are_deg.rmse);
  const Eigen::Vector3d drift = p.origin_drift_m.value_or(Eigen::Vector3d::Zero());
  print(text, "  {:6.3f} {:6.3f} {:6.3f}\n", drift.x(), drift.y(), drift.z());
}

void printPositions(std::string& text, const KindEvaluation& kind) {
  text += "\nmoving objects (final)       frames ids    position, ATE m           ARE   origin drift m\n";
  text += "  label  type              followed      aligned  offset as seen     deg   along     up across\n";
  for (const auto& object : kind.objects) printPosition(text, object);
  const MeanPositionErrors& mean = kind.mean_positions;
  const auto at = [&](PositionKind position) { return mean.ate_m[static_cast<std::size_t>(position)]; };
  print(text, "  mean of {:<3} objects (largest drift)    {:7.3f} {:7.3f} {:7.3f}  {:6.2f}", mean.objects,
        at(PositionKind::kAligned), at(PositionKind::kWorldOffsetRemoved), at(PositionKind::kAsSeenOffsetRemoved),
        mean.are_deg);
  print(text, "  {:6.3f} {:6.3f} {:6.3f}\n", mean.largest_drift_m.x(), mean.largest_drift_m.y(),
        mean.largest_drift_m.z());
}

void printBoxLine(std::string& text, const char* kind, const BoxErrors& boxes) {
  if (boxes.rows == 0) return;
  print(text, "  {:<18} {:5}  {:6.2f} {:5.1f} %  {:6.2f}  {:6.2f}", kind, boxes.rows, boxes.iou_2d,
        100 * boxes.over_half_2d, boxes.iou_bird, boxes.iou_3d);
  print(text, "  {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:7.2f}\n", boxes.center_m.mean, boxes.heading_deg.mean,
        boxes.length_m.mean, boxes.width_m.mean, boxes.height_m.mean);
}

/// A section, unless it has no lines.
void printSection(std::string& text, const std::string& head, const std::string& lines) {
  if (!lines.empty()) text.append("\n").append(head).append("\n").append(lines);
}

void printSizeLine(std::string& text, const char* kind, const BoxErrors& boxes) {
  if (boxes.rows_with_cuboid == 0) return;
  print(text, "  {:<18} {:5} cuboids {:24.1f} % {:6.1f} % {:6.1f} %\n", kind, boxes.rows_with_cuboid,
        100 * boxes.size_within_2_sigma.x(), 100 * boxes.size_within_2_sigma.y(), 100 * boxes.size_within_2_sigma.z());
}

void printBoxes(std::string& text, const Evaluation& e) {
  text += "\nboxes                 rows  IoU in    over     IoU     IoU   mean error of\n";
  text += "                             image      .5   above      3D   center heading  length   width  height\n";
  text += "                                                                  m     deg       m       m       m\n";
  printBoxLine(text, "final to 30 m", e.final.boxes_within_30m);
  printBoxLine(text, "final 30 to 50 m", e.final.boxes_from_30_to_50m);
  printBoxLine(text, "online to 30 m", e.online.boxes_within_30m);
  printBoxLine(text, "online 30 to 50 m", e.online.boxes_from_30_to_50m);
  std::string lines;
  printSizeLine(lines, "final to 30 m", e.final.boxes_within_30m);
  printSizeLine(lines, "final 30 to 50 m", e.final.boxes_from_30_to_50m);
  printSizeLine(lines, "online to 30 m", e.online.boxes_within_30m);
  printSizeLine(lines, "online 30 to 50 m", e.online.boxes_from_30_to_50m);
  printSection(text, "sizes within two of their standard deviations    length    width   height", lines);
}

void printHotaLine(std::string& text, const std::string& what, const Hota& hota) {
  if (hota.labels == 0 && hota.rows == 0) return;
  print(text, "  {:<26} {:6} {:6}  {:5.3f}  {:5.3f}  {:5.3f}  {:5.3f}", what, hota.labels, hota.rows, hota.hota,
        hota.det_a, hota.ass_a, hota.loc_a);
  print(text, "  {:5.3f}  {:5.3f}  {:5.3f}  {:5.3f}\n", hota.det_re, hota.det_pr, hota.ass_re, hota.ass_pr);
}

void printHotaLines(std::string& text, const std::string& kind, const KindEvaluation& k) {
  printHotaLine(text, kind + " image to 30 m", k.image_within_30m);
  printHotaLine(text, kind + " image to 50 m", k.image_within_50m);
  printHotaLine(text, kind + " footprint to 30 m", k.footprint_within_30m);
  printHotaLine(text, kind + " footprint to 50 m", k.footprint_within_50m);
}

void printHota(std::string& text, const Evaluation& e) {
  std::string lines;
  printHotaLines(lines, "final", e.final);
  printHotaLines(lines, "online", e.online);
  printSection(text,
               "tracks of moving objects     labels   rows   HOTA   DetA   AssA   LocA  DetRe  DetPr  AssRe  AssPr",
               lines);
}

void printFirstReportLine(std::string& text, const char* range, const FirstReports& reports) {
  if (reports.labels == 0) return;
  print(text, "  {:<10} {:3} labels, median {:.1f}, mean {:.1f}, max {:.0f}; {} never reported ({:.0f} %)\n", range,
        reports.labels, reports.frames.median, reports.frames.mean, reports.frames.max, reports.never,
        100.0 * reports.never / reports.labels);
}

void printFirstReports(std::string& text, const Evaluation& e) {
  std::string lines;
  printFirstReportLine(lines, "to 30 m", e.online.first_within_30m);
  printFirstReportLine(lines, "to 50 m", e.online.first_within_50m);
  printSection(text, "frames from first visibility to first report (online)", lines);
}

void printReliabilityLine(std::string& text, const char* estimate, const Reliability& reliability) {
  if (reliability.rows() == 0) return;
  print(text, "  {:<8} {:6}  {:6.3f}", estimate, reliability.rows(), reliability.brier());
  const auto add = [&](bool known, double value) {
    if (known)
      print(text, " {:5.2f}", value);
    else
      text += "     -";
  };
  const auto gap = reliability.largestGap();
  add(gap.has_value(), gap.value_or(0));
  text += ' ';
  for (const ReliabilityTenth& tenth : reliability.tenths)
    add(tenth.rows > 0, tenth.rows > 0 ? tenth.shareOfHits() : 0);
  text += '\n';
}

void printKindRows(std::string& text, const char* what, const KindRows& rows) {
  const KindCounts& counts = rows.counts;
  if (counts.total() == 0) return;
  print(text, "  {}: {:.1f} % of {} right, log loss {:.3f}, {:.1f} % surely wrong\n", what, 100 * counts.shareRight(),
        counts.total(), rows.logLoss(), 100 * rows.shareSureWrong());
  for (const ObjectKind label : kAllKinds) {
    std::string line;
    int of_label = 0;
    for (const ObjectKind reported : kAllKinds) {
      print(line, " {:13}", counts.of(label, reported));
      of_label += counts.of(label, reported);
    }
    if (of_label > 0) print(text, "    {:<14}{}\n", kindName(label), line);
  }
}

void printKinds(std::string& text, const Evaluation& e) {
  std::string head = "kinds to 30 m, as ", lines;
  for (const ObjectKind kind : kAllKinds) print(head, "{:>14}", kindName(kind));
  printKindRows(lines, "final, from a track's tenth row on", e.final.kinds_within_30m.from_tenth_row);
  printKindRows(lines, "final, before", e.final.kinds_within_30m.before);
  printKindRows(lines, "online, from a track's tenth row on", e.online.kinds_within_30m.from_tenth_row);
  printKindRows(lines, "online, before", e.online.kinds_within_30m.before);
  printSection(text, head, lines);
  std::string named;
  printReliabilityLine(named, "final", e.final.kinds_within_30m.from_tenth_row.named);
  printReliabilityLine(named, "online", e.online.kinds_within_30m.from_tenth_row.named);
  printSection(text, "kinds named  rows   Brier   gap  share that is right, by tenths of kind_probability", named);
}

void printExistence(std::string& text, const Evaluation& e) {
  std::string lines;
  printReliabilityLine(lines, "final", e.final.existence);
  printReliabilityLine(lines, "online", e.online.existence);
  printSection(text, "existence    rows   Brier   gap  share that is real, by tenths of existence_probability", lines);
}

void printMaskLine(std::string& text, const char* range, const MaskErrors& masks) {
  if (masks.rows == 0) return;
  print(text, "  {:<18} {:5}  {:5}  {:5.2f}  {:5.2f}  {:6.2f} / {:.2f}\n", range, masks.rows, masks.rows_with_mask,
        masks.iou, masks.iou_of_masks, masks.boundary_px.mean, masks.boundary_px.median);
}

void printMasks(std::string& text, const Evaluation& e) {
  if (!e.masks) return;
  std::string lines;
  printMaskLine(lines, "to 30 m", e.masks->within_30m);
  printMaskLine(lines, "30 to 50 m", e.masks->from_30_to_50m);
  printSection(text, "masks (online)      rows, with mask; IoU of all, of masks; boundary error px mean / median",
               lines);
}

std::string neesText(double nees) {
  return nees < 1e3   ? fmt::format("{:.2f}", nees)
         : nees < 1e7 ? fmt::format("{:.0f}", nees)
                      : fmt::format("{:.1e}", nees);
}

void printCovarianceLine(std::string& text, const char* what, const CovarianceErrors& errors) {
  if (errors.samples == 0) return;
  print(text, "  {:<24} {:7}", what, errors.samples);
  for (const NormalizedErrors* of : {&errors.pose, &errors.position, &errors.rotation})
    print(text, " {:>7} {:>7} {:3.0f} %", neesText(of->mean_nees), neesText(of->median_nees), 100 * of->coverage_95);
  text += '\n';
}

void printCovarianceLines(std::string& text, const CovarianceEvaluation& e) {
  printCovarianceLine(text, "camera", e.camera);
  if (e.camera_mounted) printCovarianceLine(text, "camera, without mounting", *e.camera_mounted);
  if (e.camera_with_truth_noise) printCovarianceLine(text, "  and the truth's noise", *e.camera_with_truth_noise);
  printCovarianceLine(text, "camera, since the start", e.camera_pose);
  printCovarianceLine(text, "objects", e.objects);
}

void printCovariances(std::string& text, const char* kind, const std::string& lines) {
  if (lines.empty()) return;
  print(text, "\ncovariances, {:<12}  samples  pose: NEES            position: NEES        rotation: NEES\n", kind);
  text += "                                      mean  median    in    mean  median    in    mean  median    in\n";
  text += "  consistent:                         6.00    5.35  95 %    3.00    2.37  95 %    3.00    2.37  95 %\n";
  text += lines;
}

void printCovariances(std::string& text, const Evaluation& e) {
  std::string of_finals, of_online;
  printCovarianceLines(of_finals, e.final.covariances);
  printCovarianceLines(of_online, e.online.covariances);
  if (e.half_errors) {
    printCovarianceLine(of_online, "camera, of two halves", e.half_errors->camera);
    printCovarianceLine(of_online, "objects, of two halves", e.half_errors->objects);
  }
  printCovariances(text, "final", of_finals);
  printCovariances(text, "online", of_online);
}

void printComparedLine(std::string& text, const ComparedObject& object) {
  print(text, "  object {:<6} {:4}", object.label, object.ours.frames);
  for (const PositionKind position :
       {PositionKind::kAligned, PositionKind::kWorldOffsetRemoved, PositionKind::kAsSeenOffsetRemoved})
    print(text, "  {:7.3f} {:7.3f} {:+6.1f} %", object.ours.of(position).rmse, object.baseline.of(position).rmse,
          100 * object.relativeError(static_cast<std::size_t>(position)));
  text += '\n';
}

void printComparison(std::string& text, const Evaluation& e) {
  if (e.camera_against_baseline || e.objects_against_baseline)
    print(text, "\nagainst the baseline: (ATE_baseline - ATE_ours) / ATE_baseline\n");
  if (const auto& r = e.camera_against_baseline)
    print(text, "  camera {:26.3f} {:7.3f} {:+6.1f} %\n", r->ours_m, r->baseline_m, 100 * r->relative());
  if (!e.objects_against_baseline) return;
  const RunComparison& comparison = *e.objects_against_baseline;
  print(text, "  common frames       aligned                   world, offset removed     as seen, offset removed\n");
  for (const auto& object : comparison.objects) printComparedLine(text, object);
  const auto at = [&](PositionKind position) {
    return 100 * comparison.mean_relative_error[static_cast<std::size_t>(position)];
  };
  print(text, "  mean of {:<3} objects {:21.1f} % {:24.1f} % {:24.1f} %\n", comparison.objects_of_mean,
        at(PositionKind::kAligned), at(PositionKind::kWorldOffsetRemoved), at(PositionKind::kAsSeenOffsetRemoved));
}

void printRest(std::string& text, const Evaluation& e) {
  printCovariances(text, e);
  printComparison(text, e);
  if (e.latency_ms.empty()) return;
  print(text, "\nlatency from image to result, ms: p50 {:.1f}, p95 {:.1f}, p99 {:.1f}, max {:.1f}\n",
        e.latencyQuantile_ms(0.5), e.latencyQuantile_ms(0.95), e.latencyQuantile_ms(0.99), e.latency_ms.back());
}

/// Explains the measures of the table.
std::string legendOf(const Evaluation& evaluation) {
  std::string text =
      "\nATE        distance from the truth, after SE(3) alignment; 1st pose: aligned by the first pose alone\n"
      "RPE        error of the motion from one frame to the next: _t translation, _r rotation\n"
      "ARE        error of the rotation; end error: of the last position, share of the path's length\n";
  if (evaluation.final.camera_segments || evaluation.online.camera_segments)
    text +=
        "segments   one of each length begins in every tenth frame and ends in the first frame beyond it;\n"
        "           the error of its motion, divided by the length: KITTI's published figures are the mean\n"
        "           of all from 100 to 800 m\n";
  if (!evaluation.object_source.empty())
    text +=
        "position   aligned: after SE(3) alignment of the object's path; offset: in the world, without the\n"
        "           constant offset between body and label; as seen: the same from the frame's camera\n"
        "drift      how far the body's origin wanders along the label's length, height and width\n"
        "ids        tracks that followed the label; id switches: changes from one of them to another\n"
        "ME         as RPE, of an object's motion; all followed: also labels that are hidden or small, and\n"
        "           predicted rows; p95: 95 of 100 steps have less; objects' mean: of each object's root\n"
        "           mean square, the form of published figures\n"
        "false      rows of any state, at any distance, on no label or on one that never moves\n"
        "MOTA       1 - (misses + false rows + id switches) / labels; misses and labels to 50 m\n"
        "IoU        intersection over union with the label's box, cuboid or mask: 1 where they agree\n"
        "log loss   mean of -log p of a kind that is right, -log(1 - p) of a wrong one, log 2 of unknown;\n"
        "           surely wrong: of a probability of 0.95 and more\n"
        "HOTA       tracking accuracy, of detection (Det) and association (Ass), each with recall (Re)\n"
        "           and precision (Pr), and of localization (Loc): 1 is perfect\n";
  const CovarianceEvaluation& covariances = evaluation.online.covariances;
  if (covariances.camera.samples + covariances.objects.samples > 0)
    text += "NEES       squared error in units of its covariance; in: share within the region of 95 %\n";
  return text + "docs/formats.md says more of each measure, and what --json adds.\n";
}

}  // namespace

std::string tableOf(const Evaluation& evaluation) {
  std::string text;
  printHead(text, evaluation);
  printCamera(text, evaluation);
  if (!evaluation.object_source.empty()) {
    printPositions(text, evaluation.final);
    printMotions(text, evaluation);
    printDetection(text, evaluation);
    printBoxes(text, evaluation);
    printHota(text, evaluation);
    printFirstReports(text, evaluation);
    printKinds(text, evaluation);
    printExistence(text, evaluation);
    printMasks(text, evaluation);
  }
  printRest(text, evaluation);
  return text + legendOf(evaluation);
}

}  // namespace motorcade
