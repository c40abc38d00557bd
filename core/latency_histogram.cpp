#include "core/latency_histogram.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace motorcade {

void LatencyHistogram::add(double duration_ms) {
  duration_ms = std::max(duration_ms, 0.0);
  ++buckets_[bucketOf(static_cast<std::uint64_t>(std::min(duration_ms, 1e9) * 1e3))];
  ++count_;
  sum_ms_ += duration_ms;
  max_ms_ = std::max(max_ms_, duration_ms);
}

double LatencyHistogram::mean_ms() const { return count_ > 0 ? sum_ms_ / static_cast<double>(count_) : 0; }

double LatencyHistogram::percentile_ms(double fraction) const {
  assert(fraction >= 0 && fraction <= 1);
  const auto wanted = std::max<std::int64_t>(1, std::llround(std::ceil(fraction * static_cast<double>(count_))));
  std::int64_t seen = 0;
  for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
    seen += buckets_[bucket];
    if (seen >= wanted) return std::min(upperBound_ms(bucket), max_ms_);
  }
  return max_ms_;
}

std::vector<LatencyHistogram::Bucket> LatencyHistogram::buckets() const {
  std::vector<Bucket> filled;
  for (std::size_t bucket = 0; bucket < kBuckets; ++bucket)
    if (buckets_[bucket] > 0) filled.push_back({upperBound_ms(bucket), buckets_[bucket]});
  return filled;
}

/// Index of a duration's bucket. The first octave is linear: below 2 * kPerOctave microseconds a bucket is 1 us wide.
std::size_t LatencyHistogram::bucketOf(std::uint64_t duration_us) {
  const int octave = std::max(0, static_cast<int>(std::bit_width(duration_us)) - kBits - 1);
  const auto bucket = static_cast<std::size_t>(octave) * kPerOctave + (duration_us >> octave);
  return std::min(bucket, kBuckets - 1);
}

double LatencyHistogram::upperBound_ms(std::size_t bucket) {
  const auto octave = bucket < 2 * kPerOctave ? 0 : bucket / kPerOctave - 1;
  const auto mantissa = bucket - octave * kPerOctave;
  return std::ldexp(static_cast<double>(mantissa + 1), static_cast<int>(octave)) * 1e-3;
}

}  // namespace motorcade
