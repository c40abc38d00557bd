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

Feeder::Feeder(SequenceDecoder& decoder, Pipeline& pipeline, std::optional<double> pace)
    : decoder_(decoder), pipeline_(pipeline), pace_(pace), thread_([this](const std::stop_token& stopped) { feed(stopped); }) {}

void Feeder::stop() {
  thread_.request_stop();
  decoder_.stop();
}

void Feeder::feed(const std::stop_token& stopped) {
  SteadyTime start;
  std::optional<Timestamp> first;
  while (auto frame = decoder_.next()) {
    if (!first) {
      first = frame->stamp;
      start = std::chrono::steady_clock::now();
    }
    if (pace_) {
      const std::chrono::duration<double> after(secondsBetween(*first, frame->stamp) / *pace_);
      frame->due = start + std::chrono::duration_cast<std::chrono::nanoseconds>(after);
      if (!sleepUntil(frame->due, stopped)) break;
    }
    if (stopped.stop_requested() || !pipeline_.push(std::move(*frame))) break;
  }
  pipeline_.close();
}

}  // namespace motorcade
