#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/interface/tracked_drive.hpp"

/// Tests pairs that no tracker can use, and producers in each other's way.
namespace motorcade {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max(),
                       kLeast = std::numeric_limits<std::int64_t>::min();

/// Good pairs with a bad one before each: rejected pairs leave no trace in the results of the others.
class BadPairs : public testing::Test {
 protected:
  void expectRejected(const std::string& why, const std::function<void(Pair&)>& spoil) {
    Pair pair = drive_.pair(next_);
    spoil(pair);
    const auto outcome = tracker_.push(pair);
    EXPECT_EQ(outcome.status, Tracker::Push::Status::kRejected) << why;
    EXPECT_THAT(std::string(outcome.why), HasSubstr(why));
    ++rejected_;
  }
  void pushGood() {
    Pair pair = drive_.pair(next_);
    pair.frame = 10 * static_cast<std::int64_t>(next_++);
    EXPECT_EQ(tracker_.push(pair).status, Tracker::Push::Status::kAccepted);
  }
  /// Expects the results of the good pairs alone.
  void expectResultsOfGoodPairs() {
    tracker_.close();
    const std::vector<Result> results = rest(tracker_);
    ASSERT_EQ(results.size(), next_);
    for (std::size_t i = 0; i < results.size(); ++i) {
      EXPECT_EQ(results[i].frame, 10 * static_cast<std::int64_t>(i));
      EXPECT_EQ(results[i].stamp_ns, drive_.frames[i].stamp_ns);
      EXPECT_EQ(results[i].status, Result::Status::kGood);
    }
    const auto counts = tracker_.counts();
    EXPECT_EQ(counts.pushed, static_cast<std::int64_t>(next_) + rejected_);
    EXPECT_EQ(counts.rejected, rejected_);
    EXPECT_EQ(counts.results, static_cast<std::int64_t>(next_));
    EXPECT_EQ(counts.dropped + counts.untaken, 0);
  }

  const DriveInMemory drive_ = readDrive(MOTORCADE_TINY_SEQUENCE);
  Tracker tracker_{drive_.camera, replay()};
  std::size_t next_ = 0;
  std::int64_t rejected_ = 0;
};

TEST_F(BadPairs, ImagesThatAreNotOfTheCameraAreRejected) {
  const std::vector<std::pair<std::string, std::function<void(Pair&)>>> misuses = {
      {"size", [](Pair& p) { p.left.width_px = p.right.width_px = 64, p.left.height_px = p.right.height_px = 64; }},
      {"size", [](Pair& p) { p.right.width_px += 1; }},
      {"size", [](Pair& p) { p.left.height_px = -p.left.height_px; }},
      {"size", [](Pair& p) { std::swap(p.right.width_px, p.right.height_px); }},
      {"no pixels", [](Pair& p) { p.left.pixels = nullptr; }},
      {"no pixels", [](Pair& p) { p.right.pixels = nullptr; }},
      {"no pixels", [](Pair& p) { p = {}; }},
      {"format", [](Pair& p) { p.left.format = Pair::Format{9}; }},
      {"stride", [](Pair& p) { p.left.stride_bytes = 309; }},
      {"stride", [](Pair& p) { p.right.stride_bytes = -310; }},
      {"stride", [](Pair& p) { p.right.stride_bytes = kLeast; }},
      {"stride", [](Pair& p) { p.right.stride_bytes = kMost; }},
      {"stride", [](Pair& p) { p.left.format = Pair::Format::kRgb8, p.left.stride_bytes = 310; }}};
  for (const auto& [why, spoil] : misuses) {
    expectRejected(why, spoil);
    if (next_ < drive_.frames.size()) pushGood();
  }
  expectResultsOfGoodPairs();
}

TEST_F(BadPairs, InstanceLabelsThatAreNotOfTheCameraAreRejected) {
  const std::vector<std::pair<std::string, std::function<void(Pair::Image&)>>> misuses = {
      {"instance labels are not of the camera's size", [](Pair::Image& labels) { labels.width_px -= 1; }},
      {"instance labels are not of the camera's size", [](Pair::Image& labels) { labels.height_px *= -1; }},
      {"not gray of 8 or 16 bits", [](Pair::Image& labels) { labels.format = Pair::Format::kRgb8; }},
      {"not gray of 8 or 16 bits", [](Pair::Image& labels) { labels.format = Pair::Format{9}; }},
      {"labels' stride is shorter", [](Pair::Image& labels) { labels.stride_bytes = 309; }},
      {"labels' stride is shorter", [](Pair::Image& labels) { labels.stride_bytes = kLeast; }},
      {"labels' stride is shorter",
       [](Pair::Image& labels) { labels.format = Pair::Format::kGray16, labels.stride_bytes = 619; }},
      {"labels' stride is above", [](Pair::Image& labels) { labels.stride_bytes = kMost; }}};
  for (const auto& [why, spoil] : misuses) {
    expectRejected(why, [&change = spoil](Pair& pair) { change(pair.instances = pair.left); });
    if (next_ < drive_.frames.size()) pushGood();
  }
  expectResultsOfGoodPairs();
}

TEST_F(BadPairs, StampsAndNumbersThatDoNotRiseAreRejected) {
  const auto stamp = [this](std::int64_t offset_ns) {
    return [=, this](Pair& p) { p.stamp_ns = drive_.frames[next_ - 1].stamp_ns + offset_ns; };
  };
  const auto number = [](std::int64_t value) { return [=](Pair& p) { p.frame = value; }; };
  pushGood();
  expectRejected("stamp", stamp(0));
  pushGood();
  expectRejected("stamp", stamp(-1));
  pushGood();
  expectRejected("stamp", stamp(-50'000'000));
  expectRejected("stamp", [](Pair& p) { p.stamp_ns = kMost; });
  expectRejected("stamp", [](Pair& p) { p.stamp_ns = kLeast; });
  expectRejected("stamp", stamp(3'600'000'000'000));  // an hour ahead, and the next pair does not agree
  pushGood();
  expectRejected("number", number(30));  // as the last one
  expectRejected("number", number(0));
  pushGood();
  expectRejected("number", number(-2));
  expectRejected("number", number(kLeast));
  expectRejected("number", number(kMost));
  pushGood();
  expectResultsOfGoodPairs();
}

/// A camera that starts anew counts from 0 again, its clock perhaps as well.
class CameraThatStartsAnew : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(WithItsClockAndWithout, CameraThatStartsAnew, testing::Bool());

TEST_P(CameraThatStartsAnew, IsFollowedAfterFourPairs) {
  constexpr std::size_t kPairs = 16, kNew = 6, kRefused = 4;
  const DriveInMemory drive = blankDrive(kPairs);
  std::mutex mutex;
  std::vector<std::string> said;
  Tracker::Options options = replay();
  options.log = [&](Tracker::LogLevel, const std::string& text) {
    const std::lock_guard lock(mutex);
    said.push_back(text);
  };
  Tracker tracker(drive.camera, options);
  for (std::size_t i = 0; i < kPairs; ++i) {
    Pair pair = drive.pair(i);
    pair.frame = static_cast<std::int64_t>(i < kNew ? i : i - kNew);
    if (GetParam() && i >= kNew) pair.stamp_ns = drive.frames[i - kNew].stamp_ns;
    const bool rejected = i >= kNew && i < kNew + kRefused;
    EXPECT_EQ(tracker.push(pair).status == Tracker::Push::Status::kRejected, rejected) << i;
  }
  tracker.close();
  const std::vector<Result> results = rest(tracker);
  ASSERT_EQ(results.size(), kPairs - kRefused);
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].frame, static_cast<std::int64_t>(i));
    EXPECT_EQ(results[i].stamp_ns, drive.frames[i < kNew ? i : i + kRefused].stamp_ns);
  }
  const std::lock_guard lock(mutex);
  EXPECT_EQ(
      std::ranges::count_if(
          said, [](const std::string& text) { return text.find("numbers of the pairs were set back") != text.npos; }),
      1);
}

TEST_F(BadPairs, NumbersThatStayBehindOutOfOrderAreNeverAccepted) {
  pushGood();
  pushGood();
  for (const std::int64_t value : {5, 4, 3, 2, 1, 1, 1, 1})
    expectRejected("number", [value](Pair& p) { p.frame = value; });
  pushGood();
  expectResultsOfGoodPairs();
}

TEST_F(BadPairs, APushAfterCloseIsRejected) {
  pushGood();
  tracker_.close();
  tracker_.close();
  expectRejected("closed", [](Pair&) {});
  expectResultsOfGoodPairs();
  expectRejected("closed", [](Pair&) {});
}

/// Stamps in another unit, as they come from cameras that count microseconds or milliseconds.
TEST(PushMisuse, StampsInAnotherUnitAreNamed) {
  const DriveInMemory drive = readDrive(MOTORCADE_TINY_SEQUENCE);
  for (const std::int64_t unit_ns : {1'000, 1'000'000}) {
    std::mutex mutex;
    std::vector<std::string> said;
    Tracker::Options options = replay();
    options.log = [&](Tracker::LogLevel, const std::string& text) {
      const std::lock_guard lock(mutex);
      said.push_back(text);
    };
    Tracker tracker(drive.camera, options);
    for (std::size_t i = 0; i < drive.frames.size(); ++i) {
      Pair pair = drive.pair(i);
      pair.stamp_ns /= unit_ns;
      const auto outcome = tracker.push(pair);
      EXPECT_EQ(outcome.status == Tracker::Push::Status::kRejected, i > 0) << i;
      if (i > 0) {
        EXPECT_THAT(std::string(outcome.why), HasSubstr("stamps are nanoseconds"));
      }
    }
    tracker.close();
    EXPECT_EQ(rest(tracker).size(), 1U);  // no speed is reported of times that cannot be
    const std::lock_guard lock(mutex);
    EXPECT_EQ(std::ranges::count_if(
                  said, [](const std::string& text) { return text.find("must be in nanoseconds") != text.npos; }),
              1);
  }
}

/// A thousand times too many nanoseconds: every second pair is far ahead of the last one that was taken.
TEST(PushMisuse, StampsFarApartAreNamed) {
  const DriveInMemory drive = readDrive(MOTORCADE_TINY_SEQUENCE);
  Tracker tracker(drive.camera, replay());
  std::string why;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    Pair pair = drive.pair(i);
    pair.stamp_ns *= 1'000;
    const auto outcome = tracker.push(pair);
    if (outcome.status == Tracker::Push::Status::kRejected) why = outcome.why;
  }
  EXPECT_THAT(why, AllOf(HasSubstr("more than ten seconds"), HasSubstr("nanoseconds")));
}

/// Another thread pushes while one waits in `push` for room.
TEST(PushMisuse, ASecondProducerIsRejected) {
  const DriveInMemory drive = blankDrive(258);
  Tracker::Options options = replay();
  options.patience = std::chrono::hours(1);
  Tracker tracker(drive.camera, options);
  for (std::size_t i = 0; i < 256; ++i) ASSERT_EQ(tracker.push(drive.pair(i)).status, Tracker::Push::Status::kAccepted);
  Tracker::Push first;
  std::jthread producer([&] { first = tracker.push(drive.pair(256)); });
  Tracker::Push second;
  do {  // rejected for its stamp only if it gets in first
    Pair old = drive.pair(0);
    old.left.pixels = nullptr;
    second = tracker.push(old);
    std::this_thread::yield();
  } while (std::string(second.why) == "an image has no pixels");
  EXPECT_EQ(second.status, Tracker::Push::Status::kRejected);
  EXPECT_STREQ(second.why, "another thread is pushing");
  EXPECT_TRUE(tracker.wait(std::chrono::hours(1)));
  producer.join();
  EXPECT_EQ(first.status, Tracker::Push::Status::kAccepted);
}

TEST(PushMisuse, ManyProducersAtOnceLoseNothingThatWasAccepted) {
  const DriveInMemory drive = blankDrive(1);
  for (const auto policy : {Tracker::Policy::kLive, Tracker::Policy::kReplay}) {
    Tracker::Options options = replay();
    options.policy = policy;
    Tracker tracker(drive.camera, options);
    std::atomic<std::int64_t> stamp_ns = 0, accepted = 0;
    std::vector<std::jthread> producers;
    for (int i = 0; i < 4; ++i)
      producers.emplace_back([&] {
        for (int push = 0; push < 50; ++push) {
          Pair pair = drive.pair(0);
          pair.stamp_ns = stamp_ns.fetch_add(1'000'000);
          if (tracker.push(pair).status != Tracker::Push::Status::kRejected) ++accepted;
        }
      });
    producers.clear();
    tracker.close();
    const auto results = static_cast<std::int64_t>(rest(tracker).size());
    const auto counts = tracker.counts();
    EXPECT_EQ(counts.pushed, 200);
    EXPECT_EQ(counts.pushed, counts.rejected + accepted);
    EXPECT_EQ(accepted, results + counts.dropped);
  }
}

TEST(PushMisuse, APushThatNobodyTakesResultsForGivesUpAfterItsPatience) {
  const DriveInMemory drive = blankDrive(258);
  Tracker::Options options = replay();
  options.patience = milliseconds(1);
  Tracker tracker(drive.camera, options);
  for (std::size_t i = 0; i < 256; ++i) ASSERT_EQ(tracker.push(drive.pair(i)).status, Tracker::Push::Status::kAccepted);
  EXPECT_THAT(tracker.push(drive.pair(256)).why, HasSubstr("256 results wait"));
  ASSERT_TRUE(tracker.wait(std::chrono::hours(1)));
  EXPECT_EQ(tracker.push(drive.pair(257)).status, Tracker::Push::Status::kAccepted);
  tracker.close();
  EXPECT_EQ(rest(tracker).size(), 256u);
}

TEST(PushMisuse, TimesBeyondAnyClockAreTimesAllTheSame) {
  Tracker::Options options = replay();
  options.patience = milliseconds::max();
  const DriveInMemory drive = blankDrive(300);
  Tracker tracker(drive.camera, options);
  EXPECT_FALSE(tracker.wait(milliseconds(-1)));
  EXPECT_FALSE(tracker.wait(milliseconds::min()));
  std::jthread producer([&] {
    for (std::size_t i = 0; i < drive.frames.size(); ++i)
      EXPECT_EQ(tracker.push(drive.pair(i)).status, Tracker::Push::Status::kAccepted);
    tracker.close();
  });
  std::size_t results = 0;
  while (tracker.wait(milliseconds::max())) ++results;
  EXPECT_EQ(results, drive.frames.size());
  EXPECT_TRUE(tracker.done());
}

}  // namespace
}  // namespace motorcade
