#include "apps/pipeline/intake.hpp"

#include <atomic>
#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

StereoFrame frameAt(std::int64_t index) {
  constexpr std::int64_t kPeriod_ns = 100'000'000;
  StereoFrame frame;
  frame.stamp = {index * kPeriod_ns};
  return frame;
}

/// A frame that enters while another thread closes either is refused or comes out; it does in a few of these rounds.
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
      admission = intake.push(frameAt(pushed));
      if (isTaken(admission)) ++taken;
    }
    closer.join();
    pump.join();
    ASSERT_EQ(taken, admitted + intake.dropped()) << "round " << round;
    ASSERT_EQ(taken, intake.received());
  }
}

}  // namespace
}  // namespace motorcade
