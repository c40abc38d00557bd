#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace motorcade {

/// Durations in fixed memory, however long the run: logarithmic octaves of microseconds, each cut into 32 equal
/// buckets, so that a percentile is at most 1/32 too high. One thread adds; read it when that thread has ended.
class LatencyHistogram {
 public:
  void add(double duration_ms);

  std::int64_t count() const { return count_; }
  double mean_ms() const;
  double max_ms() const { return max_ms_; }
  /// Smallest bucket bound that `fraction` (0 to 1) of the durations do not exceed, at most the maximum; 0 when empty.
  double percentile_ms(double fraction) const;
  double sum_ms() const { return sum_ms_; }

  struct Bucket {
    double upper_ms;
    std::int64_t count;
  };
  /// Buckets with something in them, in rising order; the next one begins at `upper_ms`.
  std::vector<Bucket> buckets() const;

 private:
  static constexpr int kBits = 5;
  static constexpr std::uint64_t kPerOctave = 1u << kBits;
  static constexpr std::size_t kBuckets = 32 * kPerOctave;  // up to about 19 hours
  static std::size_t bucketOf(std::uint64_t duration_us);
  static double upperBound_ms(std::size_t bucket);

  std::array<std::int64_t, kBuckets> buckets_{};
  std::int64_t count_ = 0;
  double sum_ms_ = 0, max_ms_ = 0;
};

}  // namespace motorcade
