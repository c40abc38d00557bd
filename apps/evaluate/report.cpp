#include "apps/evaluate/report.hpp"

#include <cstdarg>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace motorcade {
namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const Statistics& s) {
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median}, {"max", s.max}, {"count", s.count}};
}

Json jsonOf(const std::optional<TrajectoryErrors>& errors) {
  if (!errors) return nullptr;
  return {{"ate_m", jsonOf(errors->ate_m)},       {"ate_first_pose_m", jsonOf(errors->ate_first_pose_m)},
          {"are_deg", jsonOf(errors->are_deg)},   {"rpe_t_m", jsonOf(errors->rpe_m)},
          {"rpe_r_deg", jsonOf(errors->rpe_deg)}, {"end_error_percent", errors->end_percent},
          {"path_length_m", errors->length_m}};
}

Json jsonOf(const MotionErrors& errors) {
  return {{"me_t_m", jsonOf(errors.me_m)},
          {"me_r_deg", jsonOf(errors.me_deg)},
          {"speed_error_mps", jsonOf(errors.speed_mps)},
          {"speed_bias_mps", errors.speed_bias_mps},
          {"speed_coverage_95", errors.speed_coverage}};
}

Json jsonOf(const DetectionCounts& counts) {
  return {{"labels", counts.labels}, {"found", counts.found}, {"recall", counts.recall()}};
}

Json jsonOf(const DetectionErrors& errors) {
  return {{"within_30m", jsonOf(errors.within_30m)},
          {"from_30_to_50m", jsonOf(errors.from_30_to_50m)},
          {"within_30m_from_fifth_frame", jsonOf(errors.within_30m_from_fifth)},
          {"from_30_to_50m_from_fifth_frame", jsonOf(errors.from_30_to_50m_from_fifth)},
          {"rows", errors.rows},
          {"false_rows", errors.false_rows},
          {"false_rows_unlabeled", errors.false_rows_unlabeled},
          {"false_rows_in_dont_care", errors.false_rows_in_ignored},
          {"id_switches", errors.id_switches},
          {"mota", errors.mota},
          {"hota", errors.hota},
          {"det_a", errors.det_a},
          {"ass_a", errors.ass_a}};
}

Json jsonOf(const ObjectErrors& object) {
  return {{"label", object.label},
          {"type", object.type},
          {"track_id", object.track.value},
          {"labeled_frames", object.labeled_frames},
          {"followed_frames", object.followed_frames},
          {"tracks", object.tracks},
          {"trajectory", jsonOf(object.trajectory)},
          {"motion", jsonOf(object.motion)}};
}

Json jsonOf(const KindEvaluation& kind, bool with_objects) {
  Json json = {{"frames", kind.frames}, {"camera", jsonOf(kind.camera)}};
  if (!with_objects) return json;
  json["objects"] = Json::array();
  for (const auto& object : kind.objects) json["objects"].push_back(jsonOf(object));
  json["motion"] = jsonOf(kind.motion);
  json["detection"] = jsonOf(kind.detection);
  return json;
}

Json jsonOf(const CovarianceErrors& errors) {
  return {{"samples", errors.samples}, {"mean_nees", errors.mean_nees}, {"coverage_95", errors.coverage_95}};
}

/// Of sorted values.
double quantile(const std::vector<double>& sorted, double part) {
  return sorted.empty() ? 0 : sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1) + 0.5)];
}

// ---- the table ----

[[gnu::format(printf, 2, 3)]] void print(std::string& text, const char* format, ...) {
  char line[256];
  std::va_list arguments;
  va_start(arguments, format);
  const int length = std::vsnprintf(line, sizeof(line), format, arguments);
  va_end(arguments);
  text.append(line, std::min<std::size_t>(static_cast<std::size_t>(length), sizeof(line) - 1));
}

void printHead(std::string& text, const Evaluation& e) {
  print(text, "run       %s%s\n", e.run.c_str(), e.complete ? "" : "  (did not complete)");
  print(text, "sequence  %s\n", e.sequence.c_str());
  print(text, "frames    %zu from frame %lld; lost %d, rejected %d, dropped %d\n", e.frames_run,
        static_cast<long long>(e.first_frame), e.lost, e.rejected, e.dropped);
  print(text, "truth     camera from %s%s%s\n", e.camera_source.c_str(),
        e.object_source.empty() ? "" : ", objects from ", e.object_source.c_str());
}

void printCameraLine(std::string& text, const char* kind, const std::optional<TrajectoryErrors>& errors) {
  if (!errors) return print(text, "  %-8s too few poses\n", kind);
  print(text, "  %-8s %7.3f %7.3f %7.3f  %9.3f  %6.2f %%  %7.4f / %6.4f  %7.4f / %6.4f  %7.3f\n", kind,
        errors->ate_m.rmse, errors->ate_m.mean, errors->ate_m.median, errors->ate_first_pose_m.rmse,
        errors->end_percent, errors->rpe_m.rmse, errors->rpe_m.median, errors->rpe_deg.rmse, errors->rpe_deg.median,
        errors->are_deg.mean);
}

void printCamera(std::string& text, const Evaluation& e) {
  print(text,
        "\ncamera     ATE m, SE(3) aligned    ATE first  end error  RPE_t m            RPE_r deg         ARE deg\n");
  print(text,
        "              rmse    mean  median  pose rmse                rmse / median     rmse / median     mean\n");
  printCameraLine(text, "final", e.final.camera);
  printCameraLine(text, "online", e.online.camera);
}

void printObjects(std::string& text, const KindEvaluation& kind) {
  print(text,
        "\nmoving objects (final)   frames     ids  ATE m, SE(3) aligned    ATE body   ME_t m         ME_r deg       "
        "speed m/s\n");
  print(text,
        "  label  type             followed        rmse    mean  median  fixed rmse  mean / rmse    mean / rmse    "
        "rmse    bias\n");
  for (const auto& object : kind.objects) {
    print(text, "  %-6lld %-14s %5d/%-5d %4d", static_cast<long long>(object.label), object.type.c_str(),
          object.followed_frames, object.labeled_frames, object.tracks);
    if (!object.trajectory) {
      text += '\n';
      continue;
    }
    const TrajectoryErrors& t = *object.trajectory;
    const MotionErrors& m = object.motion;
    print(text, "  %7.3f %7.3f %7.3f  %10.3f", t.ate_m.rmse, t.ate_m.mean, t.ate_m.median, t.ate_first_pose_m.rmse);
    print(text, "  %5.3f / %5.3f  %5.2f / %5.2f  %5.2f  %+6.2f\n", m.me_m.mean, m.me_m.rmse, m.me_deg.mean,
          m.me_deg.rmse, m.speed_mps.rmse, m.speed_bias_mps);
  }
}

void printDetectionLine(std::string& text, const char* kind, const KindEvaluation& k, bool from_fifth) {
  const auto& near = from_fifth ? k.detection.within_30m_from_fifth : k.detection.within_30m;
  const auto& far = from_fifth ? k.detection.from_30_to_50m_from_fifth : k.detection.from_30_to_50m;
  print(text, "  %-8s %5.1f %% (%d/%d)  %5.1f %% (%d/%d)", kind, 100 * near.recall(), near.found, near.labels,
        100 * far.recall(), far.found, far.labels);
  print(text, "  %d of %d", k.detection.false_rows, k.detection.rows);
  if (k.detection.false_rows > 0)
    print(text, " (%d unlabeled, %d in DontCare)", k.detection.false_rows_unlabeled, k.detection.false_rows_in_ignored);
  print(text, "  %d  %.3f  %.3f  %.3f / %.3f  %.2f / %.2f  %.2f\n", k.detection.id_switches, k.detection.mota,
        k.detection.hota, k.motion.me_m.mean, k.motion.me_m.rmse, k.motion.me_deg.mean, k.motion.me_deg.rmse,
        k.motion.speed_mps.rmse);
}

void printDetection(std::string& text, const Evaluation& e) {
  print(text,
        "\ndetection: recall to 30 m, 30-50 m, false rows, id switches, MOTA, HOTA, ME_t m mean / rmse, ME_r deg mean "
        "/ rmse, speed rmse "
        "m/s\n");
  printDetectionLine(text, "final", e.final, false);
  printDetectionLine(text, "online", e.online, true);
  print(text, "  (online: recall from a label's fifth visible frame on)\n");
}

void printRest(std::string& text, const Evaluation& e) {
  for (const auto& [name, errors] :
       {std::pair("camera", &e.camera_covariance), std::pair("objects", &e.object_covariance)}) {
    if (errors->samples == 0) continue;
    print(text, "\ncovariance of %s: %.1f %% inside the 95 %% region, mean NEES %.2f (6 is consistent), %d samples",
          name, 100 * errors->coverage_95, errors->mean_nees, errors->samples);
  }
  if (e.camera_covariance.samples + e.object_covariance.samples > 0) text += '\n';
  if (!e.against_baseline.empty()) print(text, "\nagainst the baseline: (ATE_baseline - ATE_ours) / ATE_baseline\n");
  for (const auto& r : e.against_baseline)
    print(text, "  %-12s %6.3f m against %6.3f m: %+5.1f %%\n", r.what.c_str(), r.ours_m, r.baseline_m,
          100 * r.relative());
  if (e.latency_ms.empty()) return;
  print(text, "\nlatency from image to result, ms: p50 %.1f, p95 %.1f, p99 %.1f, max %.1f\n",
        quantile(e.latency_ms, 0.5), quantile(e.latency_ms, 0.95), quantile(e.latency_ms, 0.99), e.latency_ms.back());
}

}  // namespace

std::string tableOf(const Evaluation& evaluation) {
  std::string text;
  printHead(text, evaluation);
  printCamera(text, evaluation);
  if (!evaluation.object_source.empty()) {
    printObjects(text, evaluation.final);
    printDetection(text, evaluation);
  }
  printRest(text, evaluation);
  return text;
}

std::string jsonOf(const Evaluation& e) {
  const bool with_objects = !e.object_source.empty();
  Json json = {{"run", e.run.string()},
               {"sequence", e.sequence.string()},
               {"complete", e.complete},
               {"first_frame", e.first_frame},
               {"frames", e.frames_run},
               {"lost", e.lost},
               {"rejected", e.rejected},
               {"dropped", e.dropped},
               {"truth", {{"camera", e.camera_source}, {"objects", e.object_source}}},
               {"final", jsonOf(e.final, with_objects)},
               {"online", jsonOf(e.online, with_objects)},
               {"covariance", {{"camera", jsonOf(e.camera_covariance)}, {"objects", jsonOf(e.object_covariance)}}},
               {"latency_ms",
                {{"p50", quantile(e.latency_ms, 0.5)},
                 {"p95", quantile(e.latency_ms, 0.95)},
                 {"p99", quantile(e.latency_ms, 0.99)},
                 {"max", quantile(e.latency_ms, 1)}}}};
  json["baseline"] = Json::array();
  for (const auto& r : e.against_baseline) {
    json["baseline"].push_back({{"what", r.what},
                                {"ate_ours_m", r.ours_m},
                                {"ate_baseline_m", r.baseline_m},
                                {"relative_error", r.relative()}});
  }
  return json.dump(2);
}

}  // namespace motorcade
