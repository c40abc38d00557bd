#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/interface/tracked_drive.hpp"

/// Tests the placement of trackers' threads, that two trackers are as good as one, and a process that forks while it
/// has a tracker.
namespace motorcade {
namespace {

using Cpus = std::vector<int>;

Cpus cpusOf(int thread) {
  cpu_set_t set;
  CPU_ZERO(&set);
  Cpus cpus;
  if (sched_getaffinity(thread, sizeof set, &set) != 0) return cpus;  // it has ended
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(cpu, &set)) cpus.push_back(cpu);
  return cpus;
}

/// The sets of processors that the threads of this program may run on, but for those that may run on all.
std::multiset<Cpus> placements() {
  const Cpus all = cpusOf(0);
  std::multiset<Cpus> sets;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task"))
    if (const Cpus cpus = cpusOf(std::stoi(task.path().filename().string())); !cpus.empty() && cpus != all)
      sets.insert(cpus);
  return sets;
}

Tracker::Options on(const Cpus& cpus, int threads = 2) {
  Tracker::Options options = replay(threads);
  options.cpus = cpus;
  return options;
}

class PlacedTrackers : public testing::Test {
 protected:
  void SetUp() override {
    all_ = cpusOf(0);
    if (all_.size() < 2) GTEST_SKIP() << "there is one processor";
  }
  Cpus all_;
  const DriveInMemory drive_ = readDrive(MOTORCADE_TINY_SEQUENCE);
};

TEST_F(PlacedTrackers, RunOnTheirOwnProcessorsAndLeaveNoThreadThere) {
  ASSERT_TRUE(placements().empty());
  {
    Tracker first(drive_.camera, on({all_[0]})), second(drive_.camera, on({all_[1]}));
    for (std::size_t i = 0; i < drive_.frames.size(); ++i) {
      first.push(drive_.pair(i));
      second.push(drive_.pair(i));
    }
    const auto placed = placements();
    EXPECT_GE(placed.count({all_[0]}), 3u);  // what delivers, what admits, and a worker
    EXPECT_GE(placed.count({all_[1]}), 3u);
    EXPECT_EQ(placed.size(), placed.count({all_[0]}) + placed.count({all_[1]}));
  }
  track(drive_);  // by workers that come from there
  EXPECT_TRUE(placements().empty());
}

TEST_F(PlacedTrackers, GiveTheResultsOfOthers) {
  EXPECT_EQ(bytesOf(track(drive_, on({all_[1]}))), bytesOf(track(drive_)));
}

/// Other drives, axes and numbers of threads, at the same time, again and again.
TEST(TwoTrackers, GiveTheResultsThatEachGivesAlone) {
  struct Run {
    DriveInMemory drive;
    Tracker::Options options;
    std::vector<std::string> alone;
  };
  std::vector<Run> runs = {{readDrive(MOTORCADE_TINY_SEQUENCE), replay(1), {}},
                           {readDrive(MOTORCADE_SMALL_SEQUENCE), replay(2), {}}};
  runs[1].options.axes = Tracker::Axes::kRep103;
  runs[1].options.masks = true;
  if (const Cpus all = cpusOf(0); all.size() >= 2) {
    runs[0].options.cpus = {all[0]};
    runs[1].options.cpus = {all[1]};
  }
  for (Run& run : runs) {
    run.alone = bytesOf(track(run.drive, run.options));
    ASSERT_EQ(run.alone.size(), run.drive.frames.size());
  }
  std::vector<std::jthread> threads;
  for (Run& run : runs)
    threads.emplace_back([&run] {
      for (int round = 0; round < 4; ++round) EXPECT_EQ(bytesOf(track(run.drive, run.options)), run.alone);
    });
}

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
