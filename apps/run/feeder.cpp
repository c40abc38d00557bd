#include "apps/run/feeder.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace motorcade {
namespace {

/// Sleeps until a moment; false when stopped before.
bool sleepUntil(SteadyTime moment, const std::stop_token& stopped) {
  std::mutex mutex;
  std::condition_variable_any woken;
  std::unique_lock lock(mutex);
  woken.wait_until(lock, stopped, moment, [] { return false; });
  return !stopped.stop_requested();
}

}  // namespace

Feeder::Feeder(PairSource& source, Pipeline& pipeline, const Between& between)
    : source_(source),
      pipeline_(pipeline),
      clock_(between.clock),
      faults_(between.faults),
      watch_(between.watch),
      listeners_(between.listeners),
      gate_(between.gate),
      next_(source.first()),
      thread_([this](const std::stop_token& stopped) { feed(stopped); }) {}

Feeder::~Feeder() {
  stop();
  pipeline_.close();
}

void Feeder::stop() {
  thread_.request_stop();
  source_.stop();
}

void Feeder::feed(const std::stop_token& stopped) {
  while (auto frame = source_.next()) {
    passGate(stopped);
    if (clock_) {
      if (!clock_->started()) clock_->start(frame->head.stamp, std::chrono::steady_clock::now());
      frame->due = clock_->due(frame->head.stamp);
      if (!sleepUntil(frame->due, stopped)) break;
    }
    if (stopped.stop_requested() || !enter(std::move(*frame), stopped)) break;
  }
  if (faults_ && !stopped.stop_requested()) faults_->finish(pipelineAfterFaults(stopped));
  if (watch_) watch_->finish();
  pipeline_.close();
}

/// Waits while the replay is held, and makes further pairs due later by as long.
void Feeder::passGate(const std::stop_token& stopped) {
  if (!gate_) return;
  const auto held = gate_->pass(stopped);
  if (clock_ && clock_->started()) clock_->postpone(held);
}

/// Enters a frame, after passing over the pairs before it that the source left out.
bool Feeder::enter(StereoFrame frame, const std::stop_token& stopped) {
  for (; next_ < frame.head.frame; ++next_.value) {
    const Timestamp stamp = source_.stampOf(next_);
    pipeline_.passOver(next_, faults_ ? faults_->shifted(stamp) : stamp);
  }
  ++next_.value;
  return faults_ ? faults_->give(std::move(frame), pipelineAfterFaults(stopped)) : push(std::move(frame));
}

/// Pushes the pair before looking at it, so that it is not delayed. The pipeline and the watch ignore a late pair.
bool Feeder::push(StereoFrame frame) {
  const StereoFrame seen = frame;
  const Admission admission = pipeline_.push(std::move(frame));
  if (admission == Admission::kClosed) return false;
  for (RunListener* const listener : listeners_) listener->frameEntered(seen);
  return !watch_ || admission == Admission::kLate || watch_->admits(seen);
}

FaultInjector::Outlet Feeder::pipelineAfterFaults(const std::stop_token& stopped) {
  return {.push = [this](StereoFrame frame) { return push(std::move(frame)); },
          .pass_over = [this](FrameId frame, Timestamp stamp) { pipeline_.passOver(frame, stamp); },
          .wait =
              [stopped](std::chrono::duration<double> time) {
                const auto ticks = std::chrono::duration_cast<SteadyTime::duration>(time);
                sleepUntil(std::chrono::steady_clock::now() + ticks, stopped);
              }};
}

}  // namespace motorcade
