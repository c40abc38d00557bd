#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/interface/tracked_drive.hpp"

/// A process that forks while it has a tracker.
namespace motorcade {
namespace {

using PushStatus = Tracker::Push::Status;

/// Runs checks in a child, which has a minute. Returns the number of the first one that fails, 0 when all hold, or -1
/// when the child did not end by itself.
int failedInChild(const std::vector<std::function<bool()>>& checks) {
  constexpr unsigned kPatience_s = 60;
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(kPatience_s);
    for (std::size_t i = 0; i < checks.size(); ++i)
      if (!checks[i]()) ::_exit(static_cast<int>(i) + 1);
    ::_exit(0);
  }
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

template <class Call>
bool isRefused(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.field() == "tracker";
  }
  return false;
}

class TrackerFork : public testing::Test {
 protected:
  void SetUp() override {
    for (std::size_t i = 0; i < kBefore; ++i) ASSERT_NE(push(i), PushStatus::kRejected);
  }
  PushStatus push(std::size_t index) { return tracker_->push(drive_.pair(index)).status; }

  static constexpr std::size_t kFrames = 12, kBefore = 4;
  DriveInMemory drive_ = blankDrive(kFrames);
  std::unique_ptr<Tracker> tracker_ = std::make_unique<Tracker>(drive_.camera, replay());
};

TEST_F(TrackerFork, TheChildMayDropWhatItInherited) {
  EXPECT_EQ(failedInChild({[this] {
              tracker_.reset();
              return true;
            }}),
            0);
}

TEST_F(TrackerFork, TheChildIsToldThatTheTrackerIsNotItsOwn) {
  EXPECT_EQ(failedInChild({[this] { return push(kBefore) == PushStatus::kRejected; },
                           [this] { return isRefused([this] { tracker_->poll(); }); },
                           [this] { return isRefused([this] { tracker_->wait(std::chrono::hours(1)); }); },
                           [this] { return isRefused([this] { tracker_->on_result({}); }); },
                           [this] { return isRefused([this] { tracker_->on_final({}); }); },
                           [this] { return isRefused([this] { tracker_->reset(); }); },
                           [this] { return tracker_->done() && tracker_->counts().pushed == 0; },
                           [this] {
                             tracker_->close();
                             return true;
                           }}),
            0);
}

TEST_F(TrackerFork, TheChildMayMakeOneOfItsOwn) {
  EXPECT_EQ(failedInChild({[this] { return track(drive_).size() == kFrames; }}), 0);
}

TEST_F(TrackerFork, TheParentGoesOn) {
  EXPECT_EQ(failedInChild({[this] {
              tracker_.reset();
              return true;
            }}),
            0);
  for (std::size_t i = kBefore; i < kFrames; ++i) EXPECT_NE(push(i), PushStatus::kRejected);
  tracker_->close();
  EXPECT_EQ(rest(*tracker_).size(), kFrames);
}

}  // namespace
}  // namespace motorcade
