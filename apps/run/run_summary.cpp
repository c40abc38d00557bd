#include "apps/run/run_summary.hpp"

#include <cmath>
#include <csignal>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/console/own_program.hpp"
#include "io/files/json_text.hpp"
#include "io/results/run_folder.hpp"

namespace motorcade {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value) { return std::round(value * 1e6) / 1e6; }

Json toJson(const LatencyHistogram& histogram) {
  return {{"count", histogram.count()},
          {"mean", rounded(histogram.mean_ms())},
          {"p50", rounded(histogram.percentile_ms(0.50))},
          {"p95", rounded(histogram.percentile_ms(0.95))},
          {"p99", rounded(histogram.percentile_ms(0.99))},
          {"max", rounded(histogram.max_ms())}};
}

/// Adds the buckets: the upper bound and the count of each.
Json withBuckets(const LatencyHistogram& histogram) {
  Json json = toJson(histogram), buckets = Json::array();
  for (const auto& bucket : histogram.buckets()) buckets.push_back({rounded(bucket.upper_ms), bucket.count});
  json["buckets"] = buckets;
  return json;
}

Json byStage(const std::array<LatencyHistogram, kStageCount>& histograms) {
  Json json;
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    json[std::string(kStageKeys[stage])] = toJson(histograms[stage]);
  return json;
}

Json toJson(const SolverCounters& solver) {
  return {{"updates", solver.updates},
          {"relinearizations", solver.relinearizations},
          {"reorderings", solver.reorderings},
          {"batch_solves", solver.batch_solves},
          {"variables", solver.variables},
          {"factors", solver.factors},
          {"retired_variables", solver.retired_variables},
          {"chi2", solver.chi2},
          {"disparity_offset_px", solver.disparity_offset_px},
          {"disparity_offset_sigma_px", solver.disparity_offset_sigma_px},
          {"disparity_shake_px", solver.disparity_shake_px}};
}

Json toJson(const QueueMark& queue) {
  return {{"name", queue.name}, {"high_water", queue.high_water}, {"bound", queue.bound}};
}

/// Counts of the causes that occurred.
Json byCause(const PipelineSummary& pipeline) {
  Json counts = Json::object();
  for (std::size_t cause = 1; cause < kCauseCount; ++cause)
    if (pipeline.causes[cause] > 0)
      counts[std::string(causeName(static_cast<FrameCause>(cause)))] = pipeline.causes[cause];
  return counts;
}

/// The frame numbers are null if the finding is from the first pairs.
Json toJson(const RigFinding& found) {
  const auto frame = [&](FrameId id) { return found.last_good ? Json(id.value) : Json(nullptr); };
  return {{"name", found.finding.name},
          {"worthless", found.finding.worthless},
          {"text", found.finding.text},
          {"last_good_frame", frame(found.last_good.value_or(FrameId{}))},
          {"first_bad_frame", frame(found.first_bad)}};
}

Json toJson(const std::vector<RigFinding>& found) {
  Json list = Json::array();
  for (const RigFinding& each : found) list.push_back(toJson(each));
  return list;
}

Json toJson(const ImageCounts& images) {
  return {{"pairs", images.pairs},
          {"left_missing", images.left_missing},
          {"right_missing", images.right_missing},
          {"left_out", images.left_out}};
}

Json framesOf(const RunSummary& summary) {
  const PipelineSummary& pipeline = summary.pipeline;
  return {{"received", pipeline.received}, {"processed", pipeline.processed},
          {"dropped", pipeline.dropped},   {"rejected", pipeline.rejected},
          {"lost", pipeline.lost},         {"degraded", pipeline.degraded},
          {"late", pipeline.late},         {"by_cause", byCause(pipeline)},
          {"segments", pipeline.segments}, {"tracked_fraction", rounded(summary.trackedFraction())}};
}

/// Null where nothing was found.
Json toJson(const std::optional<OwnVehicleView>& view) {
  if (!view) return nullptr;
  const Box& box = view->box;
  return {{"image_share", rounded(view->share)}, {"box_px", {box.left_px, box.top_px, box.right_px, box.bottom_px}}};
}

Json toJson(const RunSummary::VehicleMotionUse& motion) {
  constexpr double kDegreesPerRadian = 180 / std::numbers::pi;
  return {{"samples", motion.samples},
          {"speed_scale", rounded(motion.found.speed_scale)},
          {"yaw_rate_bias_deg_s", rounded(kDegreesPerRadian * motion.found.yaw_rate_bias_radps)},
          {"frames_left_out", motion.left_out}};
}

/// A line of its own, or nothing.
std::string shakeLine(double shake_px) {
  if (shake_px < kLeastToldShake_px) return "";
  return fmt::format("cameras     shake by {:.2f} px against each other, which the estimate allows for\n", shake_px);
}

/// Versions of the program and its libraries.
Json programVersions() {
  Json json = Json::object();
  for (const auto& [name, version] : versions()) json[name] = version;
  return json;
}

Json toJson(const WriteQueue::Load& writing) {
  return {{"high_water", writing.high_water},
          {"bound", writing.bound},
          {"views_left_out", writing.views_left_out},
          {"waits", writing.waits},
          {"waited_s", rounded(writing.waited_s)}};
}

Json toJson(const McapSummary& mcap) {
  return {{"file", mcap.file},
          {"bytes", mcap.bytes},
          {"images_left_out", mcap.images_left_out},
          {"frames_left_out", mcap.frames_left_out}};
}

}  // namespace

void RunSummary::setSequence(const Sequence& of) {
  images.left_out = of.left_out;
  for (const FramePaths& frame : of.frames) {
    images.pairs += frame.isPair() ? 1 : 0;
    images.left_missing += frame.left_missing ? 1 : 0;
    images.right_missing += frame.right_missing ? 1 : 0;
  }
  sequence = of.folder.string();
  layout = of.layout;
  given = of.given;
  calibrated_by = of.calibrated_by;
  bayer = of.bayer ? nameOf(*of.bayer) : "";
  sample_bits = of.samples ? of.samples->bits : 8;
}

double RunSummary::trackedFraction() const {
  return pipeline.received > 0 ? static_cast<double>(good_frames) / static_cast<double>(pipeline.received) : 0;
}

double RunSummary::throughput_hz() const {
  return wall_s > 0 ? static_cast<double>(pipeline.processed + pipeline.rejected) / wall_s : 0;
}

std::string toJson(const RunSummary& summary) {
  const PipelineSummary& pipeline = summary.pipeline;
  Json queues = Json::array({toJson(summary.decoded)});
  for (const QueueMark& queue : pipeline.queues) queues.push_back(toJson(queue));
  Json json{{"complete", summary.signal == 0 && !summary.refused},
            {"sequence", summary.sequence},
            {"layout", summary.layout},
            {"camera", summary.given.camera},
            {"calibration", summary.calibrated_by},
            {"calibration_from", summary.given.empty() ? "sequence" : "option"},
            {"bayer", summary.bayer},
            {"sample_bits", summary.sample_bits},
            {"images", toJson(summary.images)},
            {"ignored", summary.ignored},
            {"instances", summary.instances},
            {"inject", summary.inject},
            {"capture_rate_hz", rounded(summary.capture_rate_hz)},
            {"rate", summary.rate_hz ? Json(*summary.rate_hz) : Json("max")},
            {"policy", summary.params.policy == InputPolicy::kLive ? "live" : "replay"},
            {"threads", summary.params.threads},
            {"frames_in_flight", summary.params.frames_in_flight},
            {"frames", framesOf(summary)},
            {"findings", toJson(summary.found)},
            {"own_vehicle", toJson(summary.own_vehicle)},
            {"latency_ms", withBuckets(pipeline.latency)},
            {"latency_with_decoding_ms", withBuckets(pipeline.latency_with_decoding)},
            {"entry_wait_ms", toJson(pipeline.entry_wait)},
            {"stages_ms", byStage(pipeline.stages)},
            {"stage_waits_ms", byStage(pipeline.waits)},
            {"stage_cpu_ms", byStage(pipeline.cpu)},
            {"wall_s", rounded(summary.wall_s)},
            {"cpu_s", rounded(summary.used.cpu_s)},
            {"throughput_hz", rounded(summary.throughput_hz())},
            {"peak_memory_bytes", summary.used.peak_memory_bytes},
            {"stolen_s", rounded(summary.used.stolen_s)},
            {"involuntary_switches", summary.used.involuntary_switches},
            {"queues", queues},
            {"writing", toJson(summary.writing)},
            {"solver", toJson(pipeline.solver)},
            {"versions", programVersions()}};
  if (summary.vehicle_motion) json["vehicle_motion"] = toJson(*summary.vehicle_motion);
  if (summary.mcap) json["mcap"] = toJson(*summary.mcap);
  if (summary.signal != 0) json["interrupted_by"] = summary.signal == SIGINT ? "SIGINT" : "SIGTERM";
  return jsonText(json, 2) + "\n";
}

std::string shortReport(const RunSummary& summary, const std::string& folder) {
  const PipelineSummary& pipeline = summary.pipeline;
  const LatencyHistogram& decoded = pipeline.latency_with_decoding;
  return fmt::format(
      "frames      {} received, {} processed ({} lost), {} dropped, {} rejected\n"
      "latency     p50 {:.1f} ms, p95 {:.1f} ms, p99 {:.1f} ms, max {:.1f} ms\n"
      "and decode  p50 {:.1f} ms, p95 {:.1f} ms, p99 {:.1f} ms, max {:.1f} ms\n"
      "throughput  {:.1f} frames/s, {:.1f} ms of CPU per frame, peak memory {:.0f} MB\n"
      "machine     {:.2f} s stolen by the hypervisor, {} involuntary context switches\n"
      "{}results     {}\n",
      pipeline.received, pipeline.processed, pipeline.lost, pipeline.dropped, pipeline.rejected,
      pipeline.latency.percentile_ms(0.5), pipeline.latency.percentile_ms(0.95), pipeline.latency.percentile_ms(0.99),
      pipeline.latency.max_ms(), decoded.percentile_ms(0.50), decoded.percentile_ms(0.95), decoded.percentile_ms(0.99),
      decoded.max_ms(), summary.throughput_hz(),
      1e3 * summary.used.cpu_s / static_cast<double>(std::max<std::int64_t>(1, pipeline.received)),
      1e-6 * static_cast<double>(summary.used.peak_memory_bytes), summary.used.stolen_s,
      summary.used.involuntary_switches, shakeLine(pipeline.solver.disparity_shake_px), folder);
}

}  // namespace motorcade
