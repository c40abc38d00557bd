#include "core/latency_histogram.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr double kBucket = 1.0 / 32;  // relative width of a bucket

TEST(LatencyHistogram, IsZeroWhenEmpty) {
  const LatencyHistogram histogram;
  EXPECT_EQ(histogram.count(), 0);
  EXPECT_EQ(histogram.percentile_ms(0.5), 0);
  EXPECT_EQ(histogram.mean_ms(), 0);
}

TEST(LatencyHistogram, GivesPercentilesWithinOneBucketAtEveryScale) {
  for (const double scale_ms : {0.01, 1.0, 100.0, 10'000.0}) {
    LatencyHistogram histogram;
    for (int i = 1; i <= 1000; ++i) histogram.add(i * scale_ms);
    const double one_microsecond_ms = 0.001;
    for (const double fraction : {0.5, 0.95, 0.99}) {
      const double exact_ms = fraction * 1000 * scale_ms;
      EXPECT_GE(histogram.percentile_ms(fraction), exact_ms * (1 - 1e-9));
      EXPECT_LE(histogram.percentile_ms(fraction), exact_ms * (1 + kBucket) + one_microsecond_ms);
    }
    EXPECT_DOUBLE_EQ(histogram.percentile_ms(1), 1000 * scale_ms);
    EXPECT_DOUBLE_EQ(histogram.max_ms(), 1000 * scale_ms);
    EXPECT_NEAR(histogram.mean_ms(), 500.5 * scale_ms, 1e-9 * scale_ms);
  }
}

TEST(LatencyHistogram, AcceptsNegativeAndHugeDurations) {
  LatencyHistogram histogram;
  histogram.add(-1);
  histogram.add(1e12);
  EXPECT_EQ(histogram.count(), 2);
  EXPECT_LE(histogram.percentile_ms(0.5), 0.001);
}

TEST(LatencyHistogram, ItsBucketsHoldEveryDurationBelowTheirBounds) {
  LatencyHistogram histogram;
  for (const double duration_ms : {0.5, 0.5, 20.0, 300.0}) histogram.add(duration_ms);
  const auto buckets = histogram.buckets();
  ASSERT_EQ(buckets.size(), 3u);
  EXPECT_EQ(buckets[0].count, 2);
  EXPECT_GT(buckets[1].upper_ms, 20);
  EXPECT_LE(buckets[1].upper_ms, 20 * (1 + kBucket) + 0.001);
  EXPECT_EQ(buckets[1].count + buckets[2].count, 2);
  EXPECT_DOUBLE_EQ(histogram.sum_ms(), 321);
}

}  // namespace
}  // namespace motorcade
