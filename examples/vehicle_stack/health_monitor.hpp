#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include <motorcade/motorcade.hpp>

namespace vehicle_stack {

/// How far the vehicle may rely on its eyes. Blind: nothing was measured for longer than the limit.
enum class Level { kStarting, kHealthy, kDegraded, kBlind };
const char* nameOf(Level level);

/// Judges the camera and the tracker by what goes in, what comes out and when. It becomes worse at once, and better a
/// step at a time, each after a while without a finding. Any thread may call it; time is handed in, so that tests need
/// no clock.
class HealthMonitor {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::milliseconds;

  struct Limits {
    Duration start_within{5000};  // from the start to the first results that were measured
    int results_to_start = 5;
    Duration late_after{200};  // without a measured result: degraded
    Duration blind_after{500};
    double most_latency_ms = 150;                                       // of the 99th percentile
    double most_dropped = 0.2, most_rejected = 0.1, most_unsure = 0.3;  // shares of the window
    Duration window{3000};
    Duration recover_after{1000};
    double recover_share = 0.7;  // findings by shares and latency end below so much of their limit
  };
  struct Change {
    Level from, to;
    std::string reason;
  };
  struct Latency {
    double p50_ms = 0, p99_ms = 0, max_ms = 0;
  };

  HealthMonitor(const Limits& limits, Time start);

  /// Camera thread: a pair was handed to the tracker.
  void pushed(Time now, motorcade::Tracker::Push::Status status);
  /// Consumer thread: a result came.
  void received(Time now, const motorcade::Result& result);
  /// Watchdog: judges anew; gives the change of level where there is one.
  std::optional<Change> check(Time now);

  Level level() const;
  Latency latency() const;  // over the window

 private:
  struct Push {
    Time at;
    motorcade::Tracker::Push::Status status;
  };
  struct Arrival {
    Time at;
    double latency_ms;
    bool sure;  // measured, with no cause for doubt
  };
  struct Finding {
    Level level;
    std::string reason;
  };

  void forgetBefore(Time time);
  Finding judged(Time now) const;
  Finding judgedShares() const;
  std::string whyBlind(Time now) const;
  double shareOf(motorcade::Tracker::Push::Status status) const;
  Latency latencyOfWindow() const;
  std::optional<Change> changeTo(Level level, std::string reason);

  Limits limits_;
  mutable std::mutex mutex_;
  Level level_ = Level::kStarting;
  Time start_, last_push_, last_result_, last_measured_;
  std::optional<Time> better_since_;
  int measured_ = 0;
  std::deque<Push> pushes_;      // of the window
  std::deque<Arrival> results_;  // of the window
};

}  // namespace vehicle_stack
