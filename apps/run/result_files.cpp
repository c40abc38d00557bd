#include "apps/run/result_files.hpp"

#include <chrono>
#include <thread>
#include <utility>

namespace motorcade {

ResultFiles::ResultFiles(RunFolderWriter& folder, ObjectViewWriter* views, FaultSpec faults)
    : folder_(folder), views_(views), faults_(std::move(faults)) {}

void ResultFiles::write(const WrittenResult& written) const {
  const PipelineResult& result = written.result;
  writeDropped(result);
  if (written.has_frame) writeFrame(result, written.has_view);
  for (const FrameEstimate& estimate : result.finals) folder_.writeFinal(estimate);
}

void ResultFiles::writeDropped(const PipelineResult& result) const {
  for (const FrameEstimate& estimate : result.dropped) {
    FrameTiming timing;
    timing.head = estimate.head;
    timing.due = timing.published = result.timing.due;
    folder_.writeTiming(timing);
    folder_.writeOnline(estimate);
  }
}

void ResultFiles::writeFrame(const PipelineResult& result, bool with_view) const {
  std::this_thread::sleep_for(std::chrono::duration<double>(diskStall_s(faults_, result.online.head.frame)));
  folder_.writeTiming(result.timing);
  folder_.writeOnline(result.online);
  if (views_ && with_view) views_->write(result);
  for (const FrameEstimate& estimate : result.settled) folder_.writeSettled(estimate);
}

}  // namespace motorcade
