#include "apps/pipeline/frame_clock.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kRefused_ns = -1;

/// Times by the clock; `kRefused_ns` where it refuses one.
std::vector<std::int64_t> read(FrameClock& clock, const std::vector<std::int64_t>& stamps_ns) {
  std::vector<std::int64_t> times;
  for (const std::int64_t stamp : stamps_ns) {
    const auto time = clock.read({stamp});
    times.push_back(time ? time->ns : kRefused_ns);
  }
  return times;
}

TEST(FrameClock, LeavesTimesInOrderAlone) {
  FrameClock clock;
  EXPECT_THAT(read(clock, {-5, 0, 1, 7, 1'000'000}), ElementsAre(-5, 0, 1, 7, 1'000'000));
  EXPECT_EQ(clock.ahead_ns(), 0);
}

TEST(FrameClock, RefusesSingleFramesThatAreNotAfterTheOneBefore) {
  FrameClock clock;
  EXPECT_THAT(read(clock, {10, 20, 20, 15, 30}), ElementsAre(10, 20, kRefused_ns, kRefused_ns, 30));
  EXPECT_EQ(clock.ahead_ns(), 0);
}

TEST(FrameClock, ExpectsAFrameOnePeriodAfterTheOneBefore) {
  FrameClock clock;
  read(clock, {10, 20, 15});
  EXPECT_EQ(clock.expected().ns, 30);
  read(clock, {16});
  EXPECT_EQ(clock.expected().ns, 40);
  read(clock, {50, 60, 60});
  EXPECT_EQ(clock.expected().ns, 70);
}

TEST(FrameClock, RefusesForeverWhatIsNeverInOrder) {
  FrameClock clock;
  EXPECT_EQ(read(clock, {100, 50, 40, 30, 20, 10, 10, 10, 10}).back(), kRefused_ns);
}

TEST(FrameClock, GoesOnAtTheSamePaceAfterItWasSetBack) {
  FrameClock clock;
  EXPECT_THAT(read(clock, {1000, 1010, 110, 120, 130, 140, 150, 160}),
              ElementsAre(1000, 1010, kRefused_ns, kRefused_ns, kRefused_ns, kRefused_ns, 1060, 1070));
  EXPECT_EQ(clock.ahead_ns(), 910);
}

TEST(FrameClock, RefusesOneTimeFarAhead) {
  FrameClock clock;
  constexpr std::int64_t kFar = FrameClock::kFarAhead_ns + 21;
  EXPECT_THAT(read(clock, {10, 20, kFar, 40, 50}), ElementsAre(10, 20, kRefused_ns, 40, 50));
  EXPECT_THAT(read(clock, {60, kFar - 1}), ElementsAre(60, kFar - 1));
}

TEST(FrameClock, FollowsAClockThatWentAhead) {
  FrameClock clock;
  constexpr std::int64_t kFar = FrameClock::kFarAhead_ns + 100;
  EXPECT_THAT(read(clock, {10, kFar, kFar + 10, kFar + 20}), ElementsAre(10, kRefused_ns, kFar + 10, kFar + 20));
}

TEST(FrameClock, CanBeSetBackTwice) {
  FrameClock clock;
  const auto times = read(clock, {1000, 100, 110, 120, 130, 140, 10, 20, 30, 40, 50});
  EXPECT_EQ(times[5], 1050);
  EXPECT_EQ(times.back(), 1100);
}

}  // namespace
}  // namespace motorcade
