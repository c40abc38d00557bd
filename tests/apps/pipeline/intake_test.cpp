#include "apps/pipeline/intake.hpp"

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

StereoFrame stampedFrame(std::int64_t index) {
  constexpr std::int64_t kPeriod_ns = 100'000'000;
  StereoFrame frame;
  frame.head.stamp = {index * kPeriod_ns};
  return frame;
}

/// A frame that enters while another thread closes either is refused or comes out; a few of these rounds hit that
/// moment.
class IntakeClosing : public testing::TestWithParam<InputPolicy> {};
INSTANTIATE_TEST_SUITE_P(Policies, IntakeClosing, testing::Values(InputPolicy::kReplay, InputPolicy::kLive));

TEST_P(IntakeClosing, LosesNoFrameThatItTook) {
  constexpr int kRounds = 100;
  const PipelineParams params{.policy = GetParam()};
  for (int round = 0; round < kRounds; ++round) {
    FreeJobs free_jobs(tokens(params));
    Entrance entrance;
    Intake intake(params, free_jobs, entrance, [](LogLevel, const std::string&) {});
    std::atomic<int> pushed = 0;
    std::int64_t admitted = 0, taken = 0;
    std::jthread pump([&] {
      while (Job* const job = intake.next([] { return false; })) {
        ++admitted;
        job->clear();
        free_jobs.giveBack(*job);
        entrance.pass();
      }
    });
    std::jthread closer([&] {
      while (pushed < round % 8) std::this_thread::yield();
      intake.close();
    });
    for (Admission admission = Admission::kTaken; admission != Admission::kClosed; ++pushed) {
      admission = intake.push(stampedFrame(pushed));
      if (isTaken(admission)) ++taken;
    }
    closer.join();
    pump.join();
    ASSERT_EQ(taken, admitted + intake.dropped()) << "round " << round;
    ASSERT_EQ(taken, intake.received());
  }
}

/// An intake whose pump is the test itself.
class LiveIntake : public testing::Test {
 protected:
  void push(std::int64_t frames) {
    for (std::int64_t i = 0; i < frames; ++i) intake_.push(stampedFrame(pushed_++));
  }
  /// The next admitted frame's id, and the dropped frames before it: those it names, and their number in all.
  std::tuple<std::int64_t, std::size_t, std::int64_t> admitted() {
    Job* const job = intake_.next([] { return false; });
    const auto named = job->dropped.size();
    const std::tuple seen{job->timing.head.frame.value, named, static_cast<std::int64_t>(named) + job->dropped_unnamed};
    job->clear();
    free_jobs_.giveBack(*job);
    entrance_.pass();
    return seen;
  }

 private:
  PipelineParams params_{.policy = InputPolicy::kLive};
  FreeJobs free_jobs_{tokens(params_)};
  Entrance entrance_;
  Intake intake_{params_, free_jobs_, entrance_, [](LogLevel, const std::string&) {}};
  std::int64_t pushed_ = 0;
};

TEST_F(LiveIntake, CountsDroppedFramesAlsoWhereThereAreTooManyToNameThem) {
  push(100'000);
  EXPECT_EQ(admitted(), std::tuple(99'999, 4096, 99'999));
  push(1);
  EXPECT_EQ(admitted(), std::tuple(100'000, 0, 0));
  push(4);
  EXPECT_EQ(admitted(), std::tuple(100'004, 3, 3));
  push(4097);  // the header of the newest finds no room
  EXPECT_EQ(admitted(), std::tuple(104'101, 4096, 4096));
  push(5000);
  EXPECT_EQ(admitted(), std::tuple(109'101, 4096, 4999));
}

/// All frames are pushed before the first one is admitted.
TEST(ReplayIntake, NamesTheFirstFrameOfAClockThatWasSetBack) {
  const PipelineParams params;
  FreeJobs free_jobs(tokens(params));
  Entrance entrance;
  std::string log;
  Intake intake(params, free_jobs, entrance, [&](LogLevel, const std::string& message) { log += message + '\n'; });
  for (const std::int64_t stamp : {100, 101, 0, 1, 2, 3, 4}) intake.push(stampedFrame(stamp));
  intake.close();
  int admitted = 0;
  for (Job* job = intake.next([] { return false; }); job; job = intake.next([] { return false; })) {
    ++admitted;
    job->clear();
    free_jobs.giveBack(*job);
  }
  EXPECT_EQ(admitted, 3);
  EXPECT_THAT(log, testing::HasSubstr("frame 6: the clock of the camera was set back"));
}

}  // namespace
}  // namespace motorcade
