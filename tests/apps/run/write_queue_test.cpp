#include "apps/run/write_queue.hpp"

#include <latch>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

/// A disk that takes nothing until it is told to.
class StalledDisk {
 public:
  explicit StalledDisk(bool fails = false) : fails_(fails) {}

  WriteQueue::Write write() {
    return [this](const WrittenResult& written) {
      if (!reached_.try_wait()) reached_.count_down();
      stall_.wait();
      if (fails_) throw std::runtime_error("the disk is full");
      frames.push_back(written.result.online.head.frame.value);
      views += written.result.measurements ? 1 : 0;
    };
  }
  /// Waits until the first result has come to the disk.
  void waitUntilReached() { reached_.wait(); }
  void goOn() { stall_.count_down(); }

  std::vector<std::int64_t> frames;
  int views = 0;

 private:
  bool fails_;
  std::latch reached_{1}, stall_{1};
};

WrittenResult resultOf(int frame) {
  WrittenResult written;
  written.result.online.head.frame = {frame};
  written.result.measurements = std::make_shared<FrameMeasurements>();
  return written;
}

TEST(WriteQueue, NobodyWaitsForADiskThatStallsWhileThereIsRoom) {
  StalledDisk disk;
  WriteQueue queue(disk.write(), {.results = 20, .with_views = 20});
  for (int i = 0; i < 20; ++i) queue.push(resultOf(i));  // or the test would not end
  disk.goOn();
  queue.close();
  ASSERT_EQ(disk.frames.size(), 20U);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(disk.frames[i], i);
  EXPECT_EQ(disk.views, 20);
  EXPECT_EQ(queue.load().waits, 0);
}

TEST(WriteQueue, ViewsAreLeftOutFirstAndCounted) {
  StalledDisk disk;
  WriteQueue queue(disk.write(), {.results = 20, .with_views = 5});
  for (int i = 0; i < 20; ++i) queue.push(resultOf(i));
  disk.goOn();
  queue.close();
  EXPECT_EQ(disk.frames.size(), 20U);
  EXPECT_EQ(disk.views, 5);
  EXPECT_EQ(queue.load().views_left_out, 15);
  EXPECT_EQ(queue.load().high_water, 20U);
}

TEST(WriteQueue, WhereItIsFullAResultWaitsAndNoneIsLost) {
  StalledDisk disk;
  WriteQueue queue(disk.write(), {.results = 3, .with_views = 3});
  for (int i = 0; i < 3; ++i) queue.push(resultOf(i));
  disk.waitUntilReached();
  std::latch pushed(1);
  std::jthread producer([&] {
    queue.push(resultOf(3));
    pushed.count_down();
  });
  EXPECT_FALSE(pushed.try_wait());
  disk.goOn();
  pushed.wait();
  queue.close();
  EXPECT_EQ(disk.frames, (std::vector<std::int64_t>{0, 1, 2, 3}));
  EXPECT_EQ(disk.views, 4);
  EXPECT_LE(queue.load().waits, 1) << "none where the disk went on before the fourth came";
}

TEST(WriteQueue, WhatTheDiskThrowsReachesWhoeverPushesOrCloses) {
  StalledDisk disk(true);
  WriteQueue queue(disk.write(), {.results = 2, .with_views = 2});
  queue.push(resultOf(0));
  queue.push(resultOf(1));
  disk.goOn();
  // Nothing is taken after the failure: sooner or later there is no room, which must not be waited for.
  EXPECT_THROW(for (int i = 2; i < 5; ++i) queue.push(resultOf(i)), std::runtime_error);
  EXPECT_THROW(queue.close(), std::runtime_error);
  EXPECT_TRUE(disk.frames.empty());
}

TEST(WriteQueue, WritesWhatWaitsWhenItIsGivenUp) {
  StalledDisk disk;
  {
    WriteQueue queue(disk.write(), {.results = 4, .with_views = 4});
    for (int i = 0; i < 4; ++i) queue.push(resultOf(i));
    disk.goOn();
  }
  EXPECT_EQ(disk.frames.size(), 4U);
}

TEST(WriteQueue, ALiveRunHasRoomForAStallOfSeconds) {
  constexpr double kFastCamera_hz = 60, kStall_s = 15;
  EXPECT_GE(static_cast<double>(WriteQueue::boundsOf(InputPolicy::kLive).results), kFastCamera_hz * kStall_s);
  EXPECT_LT(WriteQueue::boundsOf(InputPolicy::kReplay).results, 100U);
}

}  // namespace
}  // namespace motorcade
