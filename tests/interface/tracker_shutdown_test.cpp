#include <algorithm>
#include <atomic>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/interface/tracked_drive.hpp"
#include "tests/interface/waiting_thread.hpp"
#include "tests/support/data_folder.hpp"

/// Tests the end of trackers: what they lose, what they wait for, and how long.
namespace motorcade {
namespace {

using Clock = std::chrono::steady_clock;
using PushStatus = Tracker::Push::Status;
using std::chrono::milliseconds;

double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Time in milliseconds that a tracker takes to end after so many pairs, with as many in flight as there may be.
double endingUnderLoad_ms(const DriveInMemory& drive, Tracker::Policy policy, std::size_t pairs) {
  Tracker::Options options = replay();
  options.policy = policy;
  auto tracker = std::make_unique<Tracker>(drive.camera, options);
  for (std::size_t i = 0; i < pairs; ++i) {
    EXPECT_NE(tracker->push(drive.pair(i)).status, PushStatus::kRejected);  // in replay it waits for room
    if (policy == Tracker::Policy::kLive) std::this_thread::sleep_for(milliseconds(10));
  }
  const auto start = Clock::now();
  tracker.reset();
  return msSince(start);
}

/// The bound is for any machine; what it takes is printed.
void expectToEndSoon(const std::string& name, const DriveInMemory& drive) {
  constexpr double kBound_ms = 3000;
  for (const auto policy : {Tracker::Policy::kReplay, Tracker::Policy::kLive}) {
    std::vector<double> times_ms;
    for (std::size_t pairs = 1; pairs <= drive.frames.size(); ++pairs)
      times_ms.push_back(endingUnderLoad_ms(drive, policy, pairs));
    std::ranges::sort(times_ms);
    std::cout << name << (policy == Tracker::Policy::kLive ? ", live" : ", replay") << ": ends in "
              << times_ms[times_ms.size() / 2] << " ms, at most " << times_ms.back() << " ms\n";
    EXPECT_LT(times_ms.back(), kBound_ms);
  }
}

TEST(TrackerEnd, ComesSoonInMidRun) { expectToEndSoon("rendered", readDrive(MOTORCADE_SMALL_SEQUENCE)); }

TEST(TrackerEnd, ComesSoonInMidRunOnARealDrive) {
  const auto folder = test::dataFolder() / "kitti_tracking_0003";
  if (!exists(folder)) GTEST_SKIP() << folder << " is not there";
  expectToEndSoon("0003", readDrive(folder.string(), 16));
}

TEST(TrackerEnd, ComesAtOnceWithoutAnyPair) {
  for (int round = 0; round < 20; ++round) const Tracker tracker(blankDrive(0).camera, replay());
}

/// A pair is pushed for which there is no room, a thread waits for a result that does not come.
TEST(TrackerEnd, FreesThePushAndTheWaitOfOtherThreads) {
  const DriveInMemory drive = blankDrive(257);
  Tracker::Options options = replay();
  options.patience = milliseconds::max();
  auto tracker = std::make_unique<Tracker>(drive.camera, options);
  for (std::size_t i = 0; i < 256; ++i) ASSERT_EQ(tracker->push(drive.pair(i)).status, PushStatus::kAccepted);
  Tracker::Push outcome;
  WaitingThread producer([&, t = tracker.get()] { outcome = t->push(drive.pair(256)); });
  producer.awaitSleep();
  tracker.reset();
  producer.join();
  EXPECT_EQ(outcome.status, PushStatus::kRejected);

  tracker = std::make_unique<Tracker>(drive.camera, options);
  std::optional<Result> result;
  WaitingThread consumer([&, t = tracker.get()] { result = t->wait(milliseconds::max()); });
  consumer.awaitSleep();
  tracker.reset();
  consumer.join();
  EXPECT_FALSE(result);
}

TEST(TrackerClose, FreesAPushThatWaitsForRoom) {
  const DriveInMemory drive = blankDrive(257);
  Tracker::Options options = replay();
  options.patience = milliseconds::max();
  Tracker tracker(drive.camera, options);
  for (std::size_t i = 0; i < 256; ++i) ASSERT_EQ(tracker.push(drive.pair(i)).status, PushStatus::kAccepted);
  Tracker::Push outcome;
  WaitingThread producer([&] { outcome = tracker.push(drive.pair(256)); });
  producer.awaitSleep();
  tracker.close();
  producer.join();
  EXPECT_EQ(outcome.status, PushStatus::kRejected);
  EXPECT_STREQ(outcome.why, "the tracker was closed");
  EXPECT_EQ(rest(tracker).size(), 256u);
  EXPECT_TRUE(tracker.done());
}

class ClosedAmidPushes : public testing::TestWithParam<Tracker::Policy> {};
INSTANTIATE_TEST_SUITE_P(Policies, ClosedAmidPushes, testing::Values(Tracker::Policy::kLive, Tracker::Policy::kReplay));

/// Another thread closes at any moment: each pair that was accepted still has its result, or was replaced.
TEST_P(ClosedAmidPushes, LosesNoPairThatWasAccepted) {
  const DriveInMemory drive = blankDrive(60);
  for (int round = 0; round < 100; ++round) {
    Tracker::Options options = replay();
    options.policy = GetParam();
    Tracker tracker(drive.camera, options);
    std::atomic<int> pushed = 0;
    std::jthread closer([&] {
      while (pushed < round % 50) std::this_thread::yield();
      tracker.close();
    });
    std::int64_t accepted = 0;
    for (std::size_t i = 0; i < drive.frames.size(); ++i, ++pushed)
      if (tracker.push(drive.pair(i)).status != PushStatus::kRejected) ++accepted;
    closer.join();
    const std::vector<Result> results = rest(tracker);
    const auto counts = tracker.counts();
    ASSERT_EQ(accepted, static_cast<std::int64_t>(results.size()) + counts.dropped) << "round " << round;
    ASSERT_EQ(counts.pushed, counts.rejected + counts.dropped + counts.results);
    ASSERT_TRUE(tracker.done());
  }
}

TEST(TrackerCounts, AddUpInLiveAndNameWhatWasDroppedBeforeEachResult) {
  const DriveInMemory drive = readDrive(MOTORCADE_TINY_SEQUENCE);
  Tracker tracker(drive.camera, {});
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    tracker.push(drive.pair(i));
    if (i % 4 == 0) tracker.push(drive.pair(0));  // refused, and not among the dropped ones
  }
  tracker.close();
  const std::vector<Result> results = rest(tracker);
  const auto counts = tracker.counts();
  EXPECT_EQ(counts.rejected, 4);
  EXPECT_EQ(counts.pushed, counts.rejected + counts.dropped + counts.results);
  EXPECT_EQ(counts.results, static_cast<std::int64_t>(results.size()));
  std::int64_t dropped = 0;
  for (const Result& result : results) dropped += result.dropped_before;
  EXPECT_EQ(dropped, counts.dropped);  // the newest pair is never dropped
  EXPECT_TRUE(std::ranges::is_sorted(results, {}, &Result::frame));
}

/// Nobody takes any: the newest 256 stay.
TEST(TrackerCounts, TellOfResultsThatNobodyTook) {
  const DriveInMemory drive = blankDrive(300);
  Tracker tracker(drive.camera, {});
  for (std::size_t i = 0; i < 300; ++i) {
    tracker.push(drive.pair(i));
    while (tracker.counts().results <= static_cast<std::int64_t>(i)) std::this_thread::yield();
  }
  EXPECT_EQ(tracker.counts().untaken, 300 - 256);
  tracker.close();
  const std::vector<Result> results = rest(tracker);
  ASSERT_EQ(results.size(), 256u);
  EXPECT_EQ(results.front().frame, 300 - 256);
}

}  // namespace
}  // namespace motorcade
