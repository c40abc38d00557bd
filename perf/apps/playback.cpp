#include "perf/apps/playback.hpp"

#include <cstdio>
#include <string>
#include <thread>
#include <utility>

namespace motorcade::perf {
namespace {

using Clock = std::chrono::steady_clock;

void feed(FrameSource& source, Pipeline& pipeline, std::optional<double> rate_hz) {
  const auto start = Clock::now();
  for (std::int64_t index = 0; auto frame = source.next(); ++index) {
    if (rate_hz) {
      const std::chrono::duration<double> after(static_cast<double>(index) / *rate_hz);
      frame->due = start + std::chrono::duration_cast<Clock::duration>(after);
      std::this_thread::sleep_until(frame->due);
    }
    if (pipeline.push(std::move(*frame)) == Admission::kClosed) break;
  }
  pipeline.close();
}

void logProblems(LogLevel level, const std::string& text) {
  if (level == LogLevel::kError) std::fprintf(stderr, "pipeline_bench: %s\n", text.c_str());
}

/// Adds a result's figures to the playback.
void note(const PipelineResult& result, Playback& playback) {
  const FrameTiming& timing = result.timing;
  for (const FrameEstimate& dropped : result.dropped) playback.digests.online.push_back(digestOf(dropped));
  playback.digests.online.push_back(digestOf(result.online));
  for (const FrameEstimate& estimate : result.finals) playback.digests.final.push_back(digestOf(estimate));
  playback.in_pipeline.add(millisecondsBetween(timing.admitted, timing.published));
  for (std::size_t stage = 0; stage < kStageCount; ++stage) {
    playback.stage_cpu_ms[stage] += timing.stages[stage].cpu_ms;
    playback.stage_wall_ms[stage] += timing.stages[stage].duration_ms();
  }
}

}  // namespace

Playback play(FrameSource& source, const PipelineConfig& config, Stages stages, const PlaybackOptions& options) {
  Playback playback;
  Pipeline pipeline(config.pipeline, std::move(stages), logProblems);
  const ProcessUsage before = processUsage();
  const auto start = Clock::now();
  {
    const std::jthread feeder([&] { feed(source, pipeline, options.rate_hz); });
    while (const auto result = pipeline.next()) {
      note(*result, playback);
      if (options.observer) options.observer(*result);
    }
    playback.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
    playback.used = processUsage().since(before);
  }
  const PipelineEnd end = pipeline.finish();
  for (const FrameEstimate& estimate : end.finals) playback.digests.final.push_back(digestOf(estimate));
  playback.summary = end.summary;
  return playback;
}

}  // namespace motorcade::perf
