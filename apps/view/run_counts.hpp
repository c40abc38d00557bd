#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/pipeline/pipeline_result.hpp"

namespace motorcade {

/// Upper bounds of the buckets of durations; longer ones have a bucket of their own.
inline constexpr std::array<double, 18> kLatencyBounds_ms{1,  2,  3,  5,  7.5, 10,  15,  20,  25,
                                                          30, 40, 50, 75, 100, 150, 250, 500, 1000};

/// Durations by bucket, not cumulated.
struct DurationBuckets {
  std::array<std::int64_t, kLatencyBounds_ms.size() + 1> counts{};
  double sum_ms = 0;

  std::int64_t count() const;
};

/// A run's counts at one moment.
struct RunSnapshot {
  std::string state{};  // running, paused, ended or recorded
  std::int64_t received = 0, processed = 0, dropped = 0, rejected = 0, lost = 0;
  DurationBuckets latency{};
  DurationBuckets processing{};  // the stages' work, without waiting
  std::array<DurationBuckets, kStageCount> stages{};
  std::vector<QueueDepth> queues{};
  std::int64_t viewers = 0;
};

/// Counts a run's frames while it goes on. One thread counts, any thread reads; nobody waits.
class RunCounts {
 public:
  void count(const PipelineResult& result);
  /// Counts a frame of a run that is over.
  void count(FrameStatus status);
  void countTimes(double latency_ms, double processing_ms) {
    latency_.add(latency_ms);
    processing_.add(processing_ms);
  }
  /// Fills in the counts. `received` is the caller's, or the sum of the counts if that is larger.
  void read(RunSnapshot& snapshot) const;

 private:
  class Buckets {
   public:
    void add(double duration_ms);
    DurationBuckets read() const;

   private:
    std::array<std::atomic<std::int64_t>, kLatencyBounds_ms.size() + 1> counts_{};
    std::atomic<std::int64_t> sum_us_{0};
  };

  std::atomic<std::int64_t> processed_{0}, dropped_{0}, rejected_{0}, lost_{0};
  Buckets latency_, processing_;
  std::array<Buckets, kStageCount> stages_;
};

/// Counts in Prometheus' text form (exposition format 0.0.4).
std::string metricsText(const RunSnapshot& run);

}  // namespace motorcade
