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

}  // namespace
}  // namespace motorcade
