#include <atomic>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/interface/tracked_drive.hpp"
#include "tests/interface/waiting_thread.hpp"

namespace motorcade {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr std::size_t kPairs = 40;

std::vector<std::int64_t> numbersTo(std::size_t count) {
  std::vector<std::int64_t> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(static_cast<std::int64_t>(i));
  return numbers;
}

/// Returns when `holds` does; it must, sooner or later.
template <class Condition>
void waitUntil(const Condition& holds) {
  while (!holds()) std::this_thread::sleep_for(milliseconds(1));
}

class Callback : public testing::Test {
 protected:
  void push(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_NE(tracker_->push(drive_.pair(next_++)).status, Tracker::Push::Status::kRejected);
  }
  std::function<void(Result)> noting() {
    return [this](const Result& result) {
      const std::scoped_lock lock(mutex_);
      frames_.push_back(result.frame);
    };
  }
  std::vector<std::int64_t> frames() {
    const std::scoped_lock lock(mutex_);
    return frames_;
  }
  std::string logged() {
    const std::scoped_lock lock(mutex_);
    return log_;
  }
  Tracker::Options logging() {
    Tracker::Options options = replay();
    options.log = [this](Tracker::LogLevel, const std::string& line) {
      const std::scoped_lock lock(mutex_);
      log_ += line + "\n";
    };
    return options;
  }

  std::mutex mutex_;
  std::vector<std::int64_t> frames_;
  std::string log_;
  const DriveInMemory drive_ = blankDrive(kPairs);
  std::unique_ptr<Tracker> tracker_ = std::make_unique<Tracker>(drive_.camera, logging());
  std::size_t next_ = 0;
};

TEST_F(Callback, GetsTheResultsThatWaitAndThoseThatComeInOrder) {
  push(kPairs / 2);
  waitUntil([&] { return tracker_->counts().results == kPairs / 2; });
  tracker_->on_result(noting());
  waitUntil([&] { return frames().size() == kPairs / 2; });  // with no further pair to move them
  push(kPairs / 2);
  tracker_->close();
  waitUntil([&] { return tracker_->done(); });
  EXPECT_EQ(frames(), numbersTo(kPairs));
}

TEST_F(Callback, GetsTheResultsOfATrackerThatHasEnded) {
  push(kPairs);
  tracker_->close();
  waitUntil([&] { return tracker_->counts().results == kPairs; });
  EXPECT_FALSE(tracker_->done());
  tracker_->on_result(noting());
  waitUntil([&] { return tracker_->done(); });
  EXPECT_EQ(frames(), numbersTo(kPairs));
}

TEST_F(Callback, LeavesNothingToPollAndWaitUntilItIsTakenBack) {
  tracker_->on_result(noting());
  push(kPairs / 2);
  waitUntil([&] { return frames().size() == kPairs / 2; });
  EXPECT_FALSE(tracker_->poll());
  EXPECT_FALSE(tracker_->wait(milliseconds(1)));
  tracker_->on_result({});
  push(kPairs / 2);
  tracker_->close();
  EXPECT_EQ(rest(*tracker_).size(), kPairs / 2);
  EXPECT_EQ(frames().size(), kPairs / 2);
}

TEST_F(Callback, EndsAWaitOfAnotherThread) {
  std::optional<Result> waited;
  WaitingThread consumer([&] { waited = tracker_->wait(std::chrono::hours(1)); });
  consumer.awaitSleep();
  tracker_->on_result(noting());
  consumer.join();
  EXPECT_FALSE(waited);
}

TEST_F(Callback, HasReturnedWhenItIsReplaced) {
  const auto inside = std::make_shared<std::atomic<int>>(0);
  std::atomic<int> calls = 0;
  tracker_->on_result([&calls, inside](const Result&) {
    ++*inside;
    ++calls;
    std::this_thread::sleep_for(milliseconds(5));
    --*inside;
  });
  push(kPairs);
  waitUntil([&] { return calls >= 3; });
  tracker_->on_result({});
  EXPECT_EQ(*inside, 0);
  EXPECT_EQ(inside.use_count(), 1);  // and what it held is released
  const int calls_then = calls;
  std::this_thread::sleep_for(milliseconds(20));
  EXPECT_EQ(calls, calls_then);
}

TEST_F(Callback, MayCallTheTrackerAndReplaceItself) {
  tracker_->on_result([this](const Result& result) {
    EXPECT_FALSE(tracker_->poll());
    EXPECT_FALSE(tracker_->wait(std::chrono::hours(1)));
    EXPECT_FALSE(tracker_->done());
    EXPECT_GE(tracker_->counts().results, result.frame + 1);
    if (next_ < kPairs) push(1);
    if (result.frame == 1)
      tracker_->on_result([this, note = noting()](const Result& later) {
        if (later.frame == 2) tracker_->close();
        note(later);
      });
  });
  push(1);
  waitUntil([&] { return tracker_->done(); });
  EXPECT_THAT(frames(), testing::ElementsAre(2));
}

TEST_F(Callback, MayThrowAnythingWhichIsLogged) {
  tracker_->on_result([note = noting()](const Result& result) {
    note(result);
    if (result.frame == 1) throw std::runtime_error("no more room for results");
    if (result.frame == 2) throw 3;
  });
  push(kPairs);
  tracker_->close();
  waitUntil([&] { return tracker_->done(); });
  EXPECT_EQ(frames(), numbersTo(kPairs));
  EXPECT_THAT(logged(), HasSubstr("callback for results: no more room for results\n"));
  EXPECT_THAT(logged(), HasSubstr("no std::exception"));
}

/// Live results do not grow old while a callback takes its time: newer pairs replace those that wait at the entrance.
TEST(LiveCallback, ThatIsSlowGetsFewResultsAndNewOnes) {
  const DriveInMemory drive = blankDrive(400);
  Tracker tracker(drive.camera, {});
  std::atomic<std::int64_t> pushed = 0, calls = 0, oldest = 0;
  tracker.on_result([&](const Result& result) {
    ++calls;
    oldest = std::max<std::int64_t>(oldest, pushed - result.frame);
    const std::int64_t until = std::min<std::int64_t>(pushed + 10, 400);  // as long as ten pairs take
    waitUntil([&] { return pushed >= until; });
  });
  for (std::size_t i = 0; i < 400; ++i) {
    ASSERT_NE(tracker.push(drive.pair(i)).status, Tracker::Push::Status::kRejected);
    ++pushed;
    std::this_thread::sleep_for(milliseconds(1));
  }
  tracker.close();
  waitUntil([&] { return tracker.done(); });
  const auto counts = tracker.counts();
  EXPECT_EQ(counts.untaken, 0);
  EXPECT_EQ(counts.results, calls);
  EXPECT_EQ(counts.pushed, counts.dropped + counts.results);
  EXPECT_LE(calls, 100);
  EXPECT_LE(oldest, 100);  // one in the callback, few behind it; 256 results would be a wait of 2560 pairs
}

TEST(Callbacks, ThatRunWhenTheirTrackerEndsAreWaitedFor) {
  const DriveInMemory drive = blankDrive(20);
  for (int round = 0; round < 10; ++round) {
    const auto inside = std::make_shared<std::atomic<int>>(0);
    {
      Tracker tracker(drive.camera, replay());
      tracker.on_result([inside](const Result&) {
        ++*inside;
        std::this_thread::sleep_for(milliseconds(2));
        --*inside;
      });
      for (std::size_t i = 0; i < 20; ++i) tracker.push(drive.pair(i));
    }
    EXPECT_EQ(*inside, 0);
    EXPECT_EQ(inside.use_count(), 1);
  }
}

}  // namespace
}  // namespace motorcade
