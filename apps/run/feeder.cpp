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

Feeder::Feeder(SequenceDecoder& decoder, Pipeline& pipeline, CameraClock* clock)
    : decoder_(decoder),
      pipeline_(pipeline),
      clock_(clock),
      next_(decoder.first()),
      thread_([this](const std::stop_token& stopped) { feed(stopped); }) {}

void Feeder::stop() {
  thread_.request_stop();
  decoder_.stop();
}

void Feeder::feed(const std::stop_token& stopped) {
  while (auto frame = decoder_.next()) {
    if (clock_) {
      if (!clock_->started()) clock_->start(frame->stamp, std::chrono::steady_clock::now());
      frame->due = clock_->due(frame->stamp);
      if (!sleepUntil(frame->due, stopped)) break;
    }
    if (stopped.stop_requested() || !enter(std::move(*frame))) break;
  }
  pipeline_.close();
}

/// Tells first of the pairs before it that the decoder left out.
bool Feeder::enter(StereoFrame frame) {
  for (; next_ < frame.frame; ++next_.value) pipeline_.passOver({next_, decoder_.stampOf(next_)});
  ++next_.value;
  return pipeline_.push(std::move(frame));
}

}  // namespace motorcade
