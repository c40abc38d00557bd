#include "health_monitor.hpp"

#include <functional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vehicle_stack {
namespace {

using namespace std::chrono_literals;
using motorcade::Result;
using testing::ElementsAre;
using testing::HasSubstr;
using PushStatus = motorcade::Tracker::Push::Status;

constexpr auto kPeriod = 33ms;
constexpr auto kTick = 1ms;

/// A camera, a tracker and a watchdog on a clock that is moved by hand.
class HealthMonitorTest : public testing::Test {
 protected:
  struct Traffic {
    bool pushes = true, results = true;
    PushStatus push = PushStatus::kAccepted;
    Result::Status status = Result::Status::kGood;
    Result::Cause cause = Result::Cause::kNone;
    double latency_ms = 20;
  };

  void runFor(HealthMonitor::Duration time, const Traffic& traffic) {
    runFor(time, [&](int) { return traffic; });
  }
  void runFor(HealthMonitor::Duration time, const std::function<Traffic(int frame)>& traffic_of) {
    for (const auto end = now_ + time; now_ < end; now_ += kTick) {
      if (now_ >= next_pair_) {
        next_pair_ += kPeriod;
        const Traffic traffic = traffic_of(frame_++);
        if (traffic.pushes) health_.pushed(now_, traffic.push);
        if (traffic.pushes && traffic.results)
          health_.received(now_, {.status = traffic.status, .cause = traffic.cause, .latency_ms = traffic.latency_ms});
      }
      if (const auto change = health_.check(now_)) {
        EXPECT_EQ(change->to, health_.level());
        levels_.push_back(change->to);
        reason_ = change->reason;
        changed_ = now_;
      }
    }
  }

  const HealthMonitor::Limits limits_{};
  HealthMonitor::Time now_{}, next_pair_{}, changed_{};
  HealthMonitor health_{limits_, now_};
  int frame_ = 0;
  std::vector<Level> levels_;  // each change
  std::string reason_;         // of the last
};

TEST_F(HealthMonitorTest, IsHealthyAfterTheFirstResultsAndSaysSoOnce) {
  EXPECT_EQ(health_.level(), Level::kStarting);
  runFor(60s, Traffic{});
  EXPECT_THAT(levels_, ElementsAre(Level::kHealthy));
  EXPECT_EQ(changed_ - HealthMonitor::Time{}, 4 * kPeriod);
}

TEST_F(HealthMonitorTest, IsBlindWhenNothingWasMeasuredSinceTheStart) {
  runFor(4900ms, {.results = false});
  EXPECT_THAT(levels_, ElementsAre());
  runFor(200ms, {.results = false});
  EXPECT_THAT(levels_, ElementsAre(Level::kBlind));
}

TEST_F(HealthMonitorTest, FindsAStalledCameraWithinItsLimitAndRecoversStepByStep) {
  runFor(5s, Traffic{});
  const auto stalled = now_;
  runFor(2s, {.pushes = false});
  EXPECT_THAT(levels_, ElementsAre(Level::kHealthy, Level::kDegraded, Level::kBlind));
  EXPECT_THAT(reason_, HasSubstr("the camera has given no pair for 0.50 s"));
  EXPECT_LE(changed_ - stalled, limits_.blind_after);
  const auto back = now_;
  runFor(10s, Traffic{});
  EXPECT_THAT(levels_,
              ElementsAre(Level::kHealthy, Level::kDegraded, Level::kBlind, Level::kDegraded, Level::kHealthy));
  EXPECT_GE(changed_ - back, 2 * limits_.recover_after);
  EXPECT_LE(changed_ - back, 2 * limits_.recover_after + 2 * kPeriod);
}

TEST_F(HealthMonitorTest, TellsATrackerThatGivesNothingFromACameraThatDoes) {
  runFor(5s, Traffic{});
  runFor(1s, {.results = false});
  EXPECT_EQ(health_.level(), Level::kBlind);
  EXPECT_THAT(reason_, HasSubstr("pairs go in, and no result has come for 0.50 s"));
}

TEST_F(HealthMonitorTest, IsBlindWhenFramesAreOnlyPredicted) {
  runFor(5s, Traffic{});
  runFor(1s, {.status = Result::Status::kLost, .cause = Result::Cause::kNoPoints});
  EXPECT_EQ(health_.level(), Level::kBlind);
  EXPECT_THAT(reason_, HasSubstr("only lost or rejected frames for 0.50 s"));
}

TEST_F(HealthMonitorTest, IsBlindWhenEveryPairIsRejected) {
  runFor(5s, Traffic{});
  runFor(4s, {.results = false, .push = PushStatus::kRejected});
  EXPECT_EQ(health_.level(), Level::kBlind);
}

TEST_F(HealthMonitorTest, SaysThatEveryPairIsRejectedWhenNoneWasEverTaken) {
  runFor(6s, {.results = false, .push = PushStatus::kRejected});
  EXPECT_EQ(health_.level(), Level::kBlind);
  EXPECT_EQ(reason_, "every pair is rejected");
}

TEST_F(HealthMonitorTest, ACameraThatStallsAmidLostFramesIsStillTheCauseThatIsTold) {
  runFor(5s, Traffic{});
  runFor(150ms, {.status = Result::Status::kLost});
  runFor(1s, {.pushes = false});
  EXPECT_EQ(health_.level(), Level::kBlind);
  EXPECT_THAT(reason_, HasSubstr("the camera has given no pair"));
}

TEST_F(HealthMonitorTest, AFlickerWhileItRecoversBeginsTheWaitAnew) {
  runFor(5s, Traffic{});
  runFor(1s, {.pushes = false});
  runFor(300ms, Traffic{});
  runFor(600ms, {.pushes = false});
  EXPECT_EQ(health_.level(), Level::kBlind);
  runFor(900ms, Traffic{});
  EXPECT_EQ(health_.level(), Level::kBlind);
  runFor(200ms, Traffic{});
  EXPECT_EQ(health_.level(), Level::kDegraded);
}

/// Every nth frame with a fault is a share that the limits stand against.
class HealthMonitorShares : public HealthMonitorTest {
 protected:
  void expectDegradedBy(const Traffic& fault, int every_when_bad, int every_in_between, const std::string& reason) {
    const auto each = [&](int n) {
      return [n, fault](int frame) { return n != 0 && frame % n == n - 1 ? fault : Traffic{}; };
    };
    runFor(5s, each(every_in_between));
    EXPECT_THAT(levels_, ElementsAre(Level::kHealthy)) << "below its limit a share does no harm";
    runFor(4s, each(every_when_bad));
    EXPECT_EQ(health_.level(), Level::kDegraded);
    EXPECT_THAT(reason_, HasSubstr(reason));
    runFor(8s, each(every_in_between));
    EXPECT_EQ(health_.level(), Level::kDegraded) << "just below the limit is not well yet";
    runFor(8s, each(0));
    EXPECT_THAT(levels_, ElementsAre(Level::kHealthy, Level::kDegraded, Level::kHealthy));
  }
};

TEST_F(HealthMonitorShares, DropsDegradeIt) {
  expectDegradedBy({.push = PushStatus::kReplacedOlder}, 3, 6, "of the pairs are dropped for newer ones");
}

TEST_F(HealthMonitorShares, RejectedPairsDegradeIt) {
  expectDegradedBy({.results = false, .push = PushStatus::kRejected}, 5, 12, "of the pairs are rejected");
}

TEST_F(HealthMonitorShares, FramesThatAreLessSureDegradeIt) {
  expectDegradedBy({.cause = Result::Cause::kFewPoints}, 2, 4, "of the frames are lost or less sure");
}

TEST_F(HealthMonitorTest, SlowResultsDegradeItUntilTheyAreClearlyFastAgain) {
  runFor(5s, {.latency_ms = 140});
  EXPECT_EQ(health_.level(), Level::kHealthy);
  runFor(1s, {.latency_ms = 180});
  EXPECT_EQ(health_.level(), Level::kDegraded);
  EXPECT_THAT(reason_, HasSubstr("latency is 180 ms"));
  runFor(10s, {.latency_ms = 140});
  EXPECT_EQ(health_.level(), Level::kDegraded);
  runFor(10s, {.latency_ms = 90});
  EXPECT_EQ(health_.level(), Level::kHealthy);
}

TEST_F(HealthMonitorTest, LatencyIsThatOfTheWindow) {
  runFor(5s, {.latency_ms = 500});
  runFor(10s, [](int frame) { return Traffic{.latency_ms = frame % 2 == 0 ? 10.0 : 30.0}; });
  EXPECT_GE(health_.latency().p50_ms, 10);
  EXPECT_EQ(health_.latency().p99_ms, 30);
  EXPECT_EQ(health_.latency().max_ms, 30);
}

}  // namespace
}  // namespace vehicle_stack
