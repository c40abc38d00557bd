#include "apps/bridge/drive_player.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace motorcade {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int64_t kPeriodOfOnePair_ns = 100'000'000;

/// False when asked to stop meanwhile.
bool sleepUntil(Clock::time_point due, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any woken;
  std::unique_lock lock(mutex);
  woken.wait_until(lock, stop, due, [] { return false; });
  return !stop.stop_requested();
}

/// The time at which to push a pair that was captured `after_first_ns` after the first one.
Clock::time_point due(Clock::time_point start, std::int64_t after_first_ns, double speed) {
  const std::chrono::duration<double, std::nano> wait(static_cast<double>(after_first_ns) / speed);
  return start + std::chrono::duration_cast<Clock::duration>(wait);
}

}  // namespace

DrivePlayer::DrivePlayer(Recording& recording)
    : recording_(recording),
      first_ns_(recording.read(0).stamp_ns),
      last_ns_(recording.read(recording.size() - 1).stamp_ns),
      period_ns_(recording.size() > 1 ? (last_ns_ - first_ns_) / (recording.size() - 1) : kPeriodOfOnePair_ns) {}

double DrivePlayer::captureRate_hz() const { return recording_.size() > 1 ? 1e9 / static_cast<double>(period_ns_) : 0; }

void DrivePlayer::play(Tracker& tracker, const Pace& pace, const std::stop_token& stop) {
  const auto start = Clock::now();
  // A pair is overtaken when the next one is due already.
  const auto overtaken = [&](std::int64_t index) {
    return pace.live && pace.speed && index + 1 < recording_.size() &&
           Clock::now() >= due(start, (index + 1) * period_ns_, *pace.speed);
  };
  for (std::int64_t i = 0; i < recording_.size() && !stop.stop_requested(); ++i) {
    if (overtaken(i)) {
      ++counts_.overtaken;
      continue;
    }
    Pair pair = recording_.read(i);
    if (pace.speed && !sleepUntil(due(start, pair.stamp_ns - first_ns_, *pace.speed), stop)) break;
    pair.stamp_ns += offset_ns_;
    ++counts_.pushed;
    if (tracker.push(pair).status == Tracker::Push::Status::kRejected) ++counts_.rejected;
  }
  offset_ns_ += last_ns_ - first_ns_ + period_ns_;
  tracker.close();
}

}  // namespace motorcade
