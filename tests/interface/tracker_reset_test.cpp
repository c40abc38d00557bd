#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/interface/tracked_drive.hpp"
#include "tests/interface/waiting_thread.hpp"

/// A tracker that forgets its drive.
namespace motorcade {
namespace {

/// Bytes with ids counted from the least one, as those of a drive before are not used again.
std::vector<std::string> bytesButForIds(std::vector<Result> results) {
  std::int64_t least = INT64_MAX;
  for (const Result& result : results)
    for (const Result::Object& object : result.objects) least = std::min(least, object.id);
  for (Result& result : results)
    for (Result::Object& object : result.objects) object.id -= least;
  return bytesOf(results);
}

std::set<std::int64_t> idsOf(const std::vector<Result>& results) {
  std::set<std::int64_t> ids;
  for (const Result& result : results)
    for (const Result::Object& object : result.objects) ids.insert(object.id);
  return ids;
}

class Reset : public testing::Test {
 protected:
  std::vector<Result> follow(std::size_t count) {
    std::jthread producer([&, count] {
      for (std::size_t i = 0; i < count; ++i) tracker_.push(drive_.pair(i));
      tracker_.close();
    });
    return rest(tracker_);
  }
  void push(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_NE(tracker_.push(drive_.pair(i)).status, Tracker::Push::Status::kRejected);
  }
  static Tracker::Options withMasks() {
    Tracker::Options options = replay();
    options.masks = true;
    return options;
  }

  const DriveInMemory drive_ = readDrive(MOTORCADE_SMALL_SEQUENCE);
  Tracker tracker_{drive_.camera, withMasks()};
};

TEST_F(Reset, MakesATrackerAsNewButForIds) {
  const auto expected = track(drive_, withMasks());
  ASSERT_FALSE(idsOf(expected).empty());
  const auto first = follow(drive_.frames.size());
  EXPECT_EQ(bytesOf(first), bytesOf(expected));
  EXPECT_TRUE(tracker_.done());
  tracker_.reset();
  EXPECT_FALSE(tracker_.done());
  const auto second = follow(drive_.frames.size());
  EXPECT_EQ(bytesButForIds(second), bytesButForIds(expected));
  for (const std::int64_t id : idsOf(second)) EXPECT_FALSE(idsOf(first).contains(id));
}

TEST_F(Reset, AbandonsWhatIsInFlightAndCountsIt) {
  push(drive_.frames.size());
  tracker_.reset();
  EXPECT_FALSE(tracker_.poll());
  const auto after = follow(drive_.frames.size());
  EXPECT_EQ(bytesButForIds(after), bytesButForIds(track(drive_, withMasks())));
  const auto counts = tracker_.counts();
  EXPECT_EQ(counts.pushed, 2 * static_cast<std::int64_t>(drive_.frames.size()));
  EXPECT_EQ(counts.pushed, counts.rejected + counts.dropped + counts.results);
  EXPECT_EQ(counts.results, counts.untaken + static_cast<std::int64_t>(after.size()));
}

TEST_F(Reset, LetsThoseWhoWaitGoOnWaiting) {
  std::optional<Result> waited;
  push(3);
  for (int taken = 0; taken < 3; ++taken) ASSERT_TRUE(tracker_.wait(std::chrono::hours(1)));
  WaitingThread consumer([&] { waited = tracker_.wait(std::chrono::hours(1)); });
  consumer.awaitSleep();
  tracker_.reset();
  push(1);
  consumer.join();
  ASSERT_TRUE(waited);
  EXPECT_EQ(waited->frame, 0);
}

TEST_F(Reset, KeepsCallbacks) {
  std::atomic<std::size_t> results = 0, finals = 0;
  tracker_.on_result([&](const Result&) { ++results; });
  tracker_.on_final([&](const Result&) { ++finals; });
  for (std::size_t round = 1; round <= 3; ++round) {
    push(drive_.frames.size());
    tracker_.close();
    while (!tracker_.done()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(results, round * drive_.frames.size());
    EXPECT_EQ(finals, round * drive_.frames.size());
    tracker_.reset();
  }
}

TEST(ResetOfAny, EndsAPushThatWaitsForRoom) {
  const DriveInMemory drive = blankDrive(300);  // of whose results nobody takes one, beyond the 256 that may wait
  Tracker::Options patient = replay();
  patient.patience = std::chrono::hours(1);
  Tracker tracker(drive.camera, patient);
  std::atomic<bool> reset = false;
  WaitingThread producer([&] {
    for (std::size_t i = 0; i < drive.frames.size() && !reset; ++i) tracker.push(drive.pair(i));
  });
  producer.awaitSleep();
  reset = true;
  tracker.reset();
  producer.join();
}

/// A slow callback holds the results up under the live policy.
TEST(ResetOfAny, MayBeAskedForByTheCallbackForResultsButNotByThatForFinals) {
  const DriveInMemory drive = blankDrive(1);
  Tracker tracker(drive.camera, {});
  std::atomic<int> calls = 0, refused = 0;
  tracker.on_result([&](const Result&) {
    if (++calls == 3) tracker.reset();
  });
  tracker.on_final([&](const Result&) {
    try {
      tracker.reset();
    } catch (const Error& error) {
      refused += error.field() == "reset" ? 1 : 0;
    }
  });
  for (std::int64_t number = 0; calls < 4; ++number) {
    Pair pair = drive.pair(0);
    pair.stamp_ns = number * 1'000'000;
    tracker.push(pair);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  tracker.close();
  while (!tracker.done()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_GE(refused, 1);
}

TEST(ResetOfAny, MayComeFromSeveralThreadsAmidPushes) {
  const DriveInMemory drive = blankDrive(20);
  Tracker tracker(drive.camera, replay());
  {
    const auto resets = [&tracker] {
      for (int round = 0; round < 10; ++round) tracker.reset();
    };
    const std::jthread first(resets), second(resets);
    for (std::size_t i = 0; i < 20; ++i) {
      tracker.push(drive.pair(i));
      tracker.push_motion({.stamp_ns = drive.frames[i].stamp_ns, .speed_mps = 1});
      static_cast<void>(tracker.poll());
    }
  }
  tracker.reset();
  EXPECT_EQ(tracker.push(drive.pair(0)).status, Tracker::Push::Status::kAccepted);
  tracker.close();
  EXPECT_EQ(rest(tracker).size(), 1U);
}

}  // namespace
}  // namespace motorcade
