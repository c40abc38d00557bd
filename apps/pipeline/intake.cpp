#include "apps/pipeline/intake.hpp"

#include <cassert>
#include <chrono>
#include <memory>
#include <utility>

namespace motorcade {
namespace {

/// Pairs that a live run may lose between two frames and still name one by one.
constexpr std::size_t kLiveHeaders = 4096;

}  // namespace

Intake::Intake(const PipelineParams& params, FreeJobs& free_jobs, Entrance& entrance, LogCallback log)
    : policy_(params.policy),
      free_jobs_(free_jobs),
      entrance_(entrance),
      log_(std::move(log)),
      input_(ringCapacity(params)),
      headers_(live() ? kLiveHeaders : 1) {}

bool Intake::push(StereoFrame frame) {
  if (input_.closed()) return false;
  if (!frame.frame.valid()) frame.frame = next_id_;
  assert(frame.frame >= next_id_);
  next_id_ = {frame.frame.value + 1};
  if (live()) {
    announce({frame.frame, frame.stamp});
    newest_.put(std::move(frame));
  } else if (!input_.push(std::move(frame))) {
    return false;
  }
  received_.fetch_add(1, std::memory_order_relaxed);
  return true;
}

void Intake::passOver(const FrameHeader& frame) {
  assert(live() && frame.frame >= next_id_);
  if (input_.closed()) return;
  next_id_ = {frame.frame.value + 1};
  announce(frame);
  passed_over_.fetch_add(1, std::memory_order_relaxed);
  received_.fetch_add(1, std::memory_order_relaxed);
}

void Intake::announce(FrameHeader header) { headers_.tryPush(header); }

void Intake::close() {
  input_.close();
  newest_.close();
}

Job* Intake::next() {
  Job* const job = free_jobs_.take();
  if (!job) return nullptr;
  if (live()) entrance_.waitUntilPassed(admitted_);
  auto frame = live() ? newest_.take() : input_.pop();
  if (!frame) return nullptr;
  admit(*job, std::move(*frame));
  return job;
}

void Intake::admit(Job& job, StereoFrame frame) {
  job.timing = FrameTiming{};
  job.timing.admitted = std::chrono::steady_clock::now();
  if (frame.due == SteadyTime{}) frame.due = job.timing.admitted;
  job.timing.frame = frame.frame;
  job.timing.stamp = frame.stamp;
  job.timing.due = frame.due;
  job.timing.decode_ms = frame.decode_ms;
  if (frame.rejected()) log_(LogLevel::kWarning, job.name() + " is rejected: " + frame.problem);
  if (live()) job.dropped = droppedBefore(frame.frame);
  job.frame = std::make_shared<const StereoFrame>(std::move(frame));
  job.sequence = admitted_++;
}

std::vector<FrameHeader> Intake::droppedBefore(FrameId frame) {
  std::vector<FrameHeader> dropped;
  for (;;) {
    if (!header_ahead_) header_ahead_ = headers_.tryPop();
    if (!header_ahead_ || header_ahead_->frame > frame) return dropped;
    if (header_ahead_->frame < frame) dropped.push_back(*header_ahead_);
    header_ahead_.reset();
  }
}

}  // namespace motorcade
