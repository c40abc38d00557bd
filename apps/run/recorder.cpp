#include "apps/run/recorder.hpp"

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "apps/console/log.hpp"
#include "apps/run/process_usage.hpp"

namespace motorcade {

Recorder::Recorder(const ResultFiles& files, const WriteQueue::Bounds& bounds, RunListeners listeners,
                   std::size_t frames)
    : listeners_(std::move(listeners)),
      has_views_(files.hasViews()),
      progress_("frame", frames),
      queue_([files = files](const WrittenResult& written) { files.write(written); }, bounds) {}

void Recorder::record(PipelineResult result) {
  if (const auto doubt = plausibility_.observe(result.online)) logWarning(*doubt);
  if (const auto news = own_vehicle_.observe(*result.measurements)) logInfo(*news);
  if (const auto news = vehicle_motion_.observe(*result.measurements)) logWarning(*news);
  for (RunListener* const listener : listeners_) listener->frameLeft(result);
  followed_.observe(result);
  const double latency_ms = result.timing.latency_ms();
  done_ += result.dropped.size() + 1;
  queue_.push({.result = std::move(result), .has_view = has_views_});
  if (done_ % kFramesPerTrim == 0) giveBackSpareMemory();
  progress_.show(done_, fmt::format("latency {:.1f} ms", latency_ms));
}

void Recorder::recordRest(std::vector<FrameEstimate> dropped, std::vector<FrameEstimate> finals) {
  done_ += dropped.size();
  PipelineResult rest;
  rest.dropped = std::move(dropped);
  rest.finals = std::move(finals);
  rest.timing.due = std::chrono::steady_clock::now();
  queue_.push({.result = std::move(rest), .has_frame = false, .has_view = false});
}

std::optional<OwnVehicleView> Recorder::finish() {
  queue_.close();
  if (const auto news = own_vehicle_.finish()) logInfo(*news);
  return own_vehicle_.view();
}

}  // namespace motorcade
