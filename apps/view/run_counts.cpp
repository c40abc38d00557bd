#include "apps/view/run_counts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>

#include <fmt/format.h>

#include "apps/latency/latency_report.hpp"

namespace motorcade {
namespace {

void increase(std::atomic<std::int64_t>& count, std::int64_t by = 1) { count.fetch_add(by, std::memory_order_relaxed); }

void describe(std::string& text, std::string_view name, std::string_view type, std::string_view help) {
  text += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
}

void addCounter(std::string& text, std::string_view name, std::string_view help, std::int64_t value) {
  describe(text, name, "counter", help);
  text += fmt::format("{} {}\n", name, value);
}

/// `label` is `stage="name"`, or empty.
void addHistogram(std::string& text, std::string_view name, const std::string& label, const DurationBuckets& buckets) {
  const std::string before = label.empty() ? "" : label + ",", alone = label.empty() ? "" : "{" + label + "}";
  std::int64_t cumulated = 0;
  for (std::size_t i = 0; i < kLatencyBounds_ms.size(); ++i) {
    cumulated += buckets.counts[i];
    text += fmt::format("{}_bucket{{{}le=\"{}\"}} {}\n", name, before, kLatencyBounds_ms[i] * 1e-3, cumulated);
  }
  text += fmt::format("{}_bucket{{{}le=\"+Inf\"}} {}\n", name, before, buckets.count());
  text += fmt::format("{}_sum{} {}\n{}_count{} {}\n", name, alone, buckets.sum_ms * 1e-3, name, alone, buckets.count());
}

void addCounters(std::string& text, const RunSnapshot& run) {
  addCounter(text, "motorcade_frames_received_total", "Stereo pairs that came from the camera.", run.received);
  addCounter(text, "motorcade_frames_processed_total", "Frames that went through all stages.", run.processed);
  addCounter(text, "motorcade_frames_dropped_total", "Frames that never entered the pipeline.", run.dropped);
  addCounter(text, "motorcade_frames_rejected_total", "Frames whose images were of no use.", run.rejected);
  addCounter(text, "motorcade_frames_lost_total", "Processed frames without a measured ego-motion.", run.lost);
}

void addGauges(std::string& text, const RunSnapshot& run) {
  describe(text, "motorcade_queue_frames", "gauge", "Frames that wait on an edge of the pipeline.");
  for (const QueueDepth& queue : run.queues)
    text += fmt::format("motorcade_queue_frames{{queue=\"{}\"}} {}\n", queue.name, queue.waiting);
  describe(text, "motorcade_queue_bound_frames", "gauge", "The most frames that can wait there.");
  for (const QueueDepth& queue : run.queues)
    text += fmt::format("motorcade_queue_bound_frames{{queue=\"{}\"}} {}\n", queue.name, queue.bound);
  describe(text, "motorcade_viewers", "gauge", "Pages that are following the run.");
  text += fmt::format("motorcade_viewers {}\n", run.viewers);
}

}  // namespace

std::int64_t DurationBuckets::count() const { return std::accumulate(counts.begin(), counts.end(), std::int64_t{0}); }

void RunCounts::Buckets::add(double duration_ms) {
  const auto bucket = std::ranges::lower_bound(kLatencyBounds_ms, duration_ms) - kLatencyBounds_ms.begin();
  increase(counts_[static_cast<std::size_t>(bucket)]);
  increase(sum_us_, std::llround(1e3 * duration_ms));
}

DurationBuckets RunCounts::Buckets::read() const {
  DurationBuckets buckets;
  for (std::size_t i = 0; i < counts_.size(); ++i) buckets.counts[i] = counts_[i].load(std::memory_order_relaxed);
  buckets.sum_ms = 1e-3 * static_cast<double>(sum_us_.load(std::memory_order_relaxed));
  return buckets;
}

void RunCounts::count(const PipelineResult& result) {
  increase(dropped_, static_cast<std::int64_t>(result.dropped.size()) + result.dropped_unnamed);
  count(result.online.head.status);
  std::array<double, kStageCount> work_ms{};
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    const StageSpan& span = result.timing.stages[stage];
    work_ms[stage] = span.duration_ms();
    if (span.start != span.end) stages_[stage].add(work_ms[stage]);
  }
  countTimes(result.timing.latency_ms(), processing_ms(work_ms));
}

void RunCounts::count(FrameStatus status) {
  if (status == FrameStatus::kDropped) return increase(dropped_);
  increase(status == FrameStatus::kRejected ? rejected_ : processed_);
  if (status == FrameStatus::kLost) increase(lost_);
}

void RunCounts::read(RunSnapshot& snapshot) const {
  snapshot.processed = processed_.load(std::memory_order_relaxed);
  snapshot.dropped = dropped_.load(std::memory_order_relaxed);
  snapshot.rejected = rejected_.load(std::memory_order_relaxed);
  snapshot.lost = lost_.load(std::memory_order_relaxed);
  snapshot.received = std::max(snapshot.received, snapshot.processed + snapshot.dropped + snapshot.rejected);
  snapshot.latency = latency_.read();
  snapshot.processing = processing_.read();
  for (std::size_t stage = 0; stage < kStageCount; ++stage) snapshot.stages[stage] = stages_[stage].read();
}

std::string metricsText(const RunSnapshot& run) {
  std::string text;
  addCounters(text, run);
  describe(text, "motorcade_latency_seconds", "histogram", "From the moment a pair was due until its result was out.");
  addHistogram(text, "motorcade_latency_seconds", "", run.latency);
  describe(text, "motorcade_stage_seconds", "histogram", "Time that a frame spent in a stage.");
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    addHistogram(text, "motorcade_stage_seconds", fmt::format("stage=\"{}\"", kStageKeys[stage]), run.stages[stage]);
  addGauges(text, run);
  return text;
}

}  // namespace motorcade
