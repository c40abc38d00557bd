#include "apps/pipeline/publisher.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

FrameEstimate estimateOfTracks(std::int64_t s, std::initializer_list<std::int64_t> tracks) {
  FrameEstimate estimate;
  estimate.head.stamp = {s * kSecond_ns};
  for (const std::int64_t track : tracks) {
    ObjectEstimate object;
    object.track = {track};
    estimate.objects.push_back(object);
  }
  return estimate;
}

double ageOfLast(ObjectAges& ages, FrameEstimate estimate) {
  ages.fill(estimate);
  return estimate.objects.back().age_s;
}

TEST(ObjectAges, CountFromTheFirstEstimateAlsoOverGaps) {
  ObjectAges ages;
  EXPECT_DOUBLE_EQ(ageOfLast(ages, estimateOfTracks(10, {4})), 0);
  EXPECT_DOUBLE_EQ(ageOfLast(ages, estimateOfTracks(12, {4, 5})), 0);
  EXPECT_DOUBLE_EQ(ageOfLast(ages, estimateOfTracks(13, {5, 4})), 3);
  FrameEstimate none = estimateOfTracks(20, {});
  ages.fill(none);
  EXPECT_DOUBLE_EQ(ageOfLast(ages, estimateOfTracks(25, {4})), 15) << "found again";
}

TEST(ObjectAges, AreForgottenOfWhatIsGoneForLong) {
  ObjectAges ages;
  ageOfLast(ages, estimateOfTracks(10, {4}));
  EXPECT_DOUBLE_EQ(ageOfLast(ages, estimateOfTracks(100, {4})), 0);
}

}  // namespace
}  // namespace motorcade
