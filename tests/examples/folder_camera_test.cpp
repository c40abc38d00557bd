#include "folder_camera.hpp"

#include <gtest/gtest.h>

namespace vehicle_stack {
namespace {

const auto kToTheEnd = [] { return false; };

TEST(FolderCamera, TimeGoesOnWhereTheDriveBeginsAnew) {
  const FolderCamera camera(MOTORCADE_TINY_SEQUENCE, {.loops = 3}, kToTheEnd);
  ASSERT_EQ(camera.ticks(), 3 * MOTORCADE_TINY_FRAMES);
  constexpr std::int64_t kStep_ns = 100'000'000;  // of rendered drives
  for (std::int64_t tick = 0; tick < camera.ticks(); ++tick) {
    const motorcade::Pair pair = camera.pairOf(tick);
    EXPECT_EQ(pair.frame, tick);
    EXPECT_NEAR(pair.stamp_ns, tick * kStep_ns, 1000);
    EXPECT_EQ(pair.left.pixels, camera.pairOf(tick % MOTORCADE_TINY_FRAMES).left.pixels);
  }
}

TEST(FolderCamera, StampsThatAreRemadeAreAPeriodApart) {
  const FolderCamera camera(MOTORCADE_TINY_SEQUENCE, {.rate_hz = 25, .stamps = FolderCamera::Stamps::kRemade},
                            kToTheEnd);
  EXPECT_EQ(camera.pairOf(5).stamp_ns, 200'000'000);
}

TEST(FolderCamera, StallsWhenItIsTold) {
  const FolderCamera camera(MOTORCADE_TINY_SEQUENCE, {.rate_hz = 10, .stall_at_s = 0.5, .stall_for_s = 0.3}, kToTheEnd);
  for (std::int64_t tick = 0; tick < camera.ticks(); ++tick) EXPECT_EQ(camera.stalledIn(tick), tick >= 5 && tick < 8);
}

TEST(FolderCamera, GivesUpWaitingWhenItIsStopped) {
  FolderCamera camera(MOTORCADE_TINY_SEQUENCE, {.rate_hz = 0.1}, kToTheEnd);  // the second pair comes in ten seconds
  std::stop_source stop;
  EXPECT_TRUE(camera.next(stop.get_token()));
  stop.request_stop();
  EXPECT_FALSE(camera.next(stop.get_token()));
}

TEST(FolderCamera, HoldsNoMorePairsThanItIsTold) {
  EXPECT_EQ(FolderCamera(MOTORCADE_TINY_SEQUENCE, {.most_pairs = 3}, kToTheEnd).ticks(), 3);
}

}  // namespace
}  // namespace vehicle_stack
