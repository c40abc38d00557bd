#include "apps/run/recorder.hpp"

#include <utility>

#include <fmt/format.h>

#include "apps/console/log.hpp"
#include "apps/run/process_usage.hpp"

namespace motorcade {

Recorder::Recorder(RunFolderWriter& folder, RunListeners listeners, std::size_t frames)
    : folder_(folder), listeners_(std::move(listeners)), progress_("frame", frames) {}

void Recorder::record(const PipelineResult& result) {
  recordDropped(result.dropped, result.timing.due);
  folder_.writeTiming(result.timing);
  folder_.writeOnline(result.online);
  if (const auto doubt = plausibility_.observe(result.online)) logWarning(*doubt);
  if (const auto news = own_vehicle_.observe(*result.measurements)) logInfo(*news);
  if (const auto news = vehicle_motion_.observe(*result.measurements)) logWarning(*news);
  for (RunListener* const listener : listeners_) listener->frameLeft(result);
  for (const FrameEstimate& estimate : result.settled) folder_.writeSettled(estimate);
  recordFinals(result.finals);
  followed_.observe(result);
  if (++done_ % kFramesPerTrim == 0) giveBackSpareMemory();
  progress_.show(done_, fmt::format("latency {:.1f} ms", result.timing.latency_ms()));
}

void Recorder::recordDropped(const std::vector<FrameEstimate>& dropped, SteadyTime due) {
  for (const FrameEstimate& estimate : dropped) {
    FrameTiming timing;
    timing.head = estimate.head;
    timing.due = timing.published = due;
    folder_.writeTiming(timing);
    folder_.writeOnline(estimate);
    ++done_;
  }
}

void Recorder::recordFinals(const std::vector<FrameEstimate>& finals) {
  for (const FrameEstimate& estimate : finals) folder_.writeFinal(estimate);
}

std::optional<OwnVehicleView> Recorder::finish() {
  if (const auto news = own_vehicle_.finish()) logInfo(*news);
  return own_vehicle_.view();
}

}  // namespace motorcade
