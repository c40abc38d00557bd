#include "frontend/shape/existence.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(Existence, IsUndecidedBeforeAnythingIsSeen) {
  Existence existence;
  existence.addSpeed(0, 1e3);
  EXPECT_NEAR(existence.probability(), 0.5, 0.01);
}

/// The likelihood of a speed among those of traffic, Gaussian with 10 m/s, over that as an error alone.
TEST(Existence, OfASpeedIsItsLikelihoodInTrafficAgainstRest) {
  Existence existence;
  existence.addSpeed(6, 3);
  const double in_traffic = std::exp(-0.5 * 36 / (100 + 9)) / std::sqrt(100 + 9), at_rest = std::exp(-0.5 * 36 / 9) / 3;
  EXPECT_NEAR(existence.probability(), in_traffic / (in_traffic + at_rest), 1e-9);
}

TEST(Existence, AsksForTwoStandardDeviationsOfSpeed) {
  Existence within, beyond;
  within.addSpeed(1.5, 1);
  beyond.addSpeed(2.5, 1);
  EXPECT_LT(within.probability(), 0.5);
  EXPECT_GT(beyond.probability(), 0.5);
}

TEST(Existence, OfASureSpeedAloneIsNotSure) {
  Existence existence;
  existence.addSpeed(15, 0.2);
  EXPECT_GT(existence.probability(), 0.8);
  EXPECT_LT(existence.probability(), 0.9);
}

/// Most wrong matches seem to move slowly.
TEST(Existence, OfASlowSpeedAloneIsLessSure) {
  Existence walking, driving;
  walking.addSpeed(1.4, 0.1);
  driving.addSpeed(8, 0.1);
  EXPECT_GT(walking.probability(), 0.5);
  EXPECT_LT(walking.probability(), driving.probability() - 0.1);
}

TEST(Existence, FallsWhereLaterEstimatesShowNoMotion) {
  Existence existence;
  existence.addSpeed(6, 2);
  const double first = existence.probability();
  for (int frame = 0; frame < 40; ++frame) existence.addSpeed(0.5, 1);
  EXPECT_LT(existence.probability(), 0.5);
  EXPECT_LT(existence.probability(), first);
}

TEST(Existence, StaysWithWhatStoppedAfterItsMotionSettled) {
  Existence existence;
  existence.addSpeed(6, 0.5);
  existence.addSettledSpeed(6, 0.5);
  for (int frame = 0; frame < 40; ++frame) existence.addSpeed(0, 0.3);
  EXPECT_GT(existence.probability(), 0.8);
  EXPECT_GT(existence.settledProbability(), 0.8);
}

/// By hindsight the first estimate was wrong.
TEST(Existence, IsSettledByWhatIsSettledAlone) {
  Existence existence;
  existence.addSpeed(6, 0.5);
  existence.addSettledSpeed(0.5, 0.5);
  EXPECT_GT(existence.probability(), 0.8);
  EXPECT_LT(existence.settledProbability(), 0.2);
}

TEST(Existence, GrowsWithWhatMovesAndFallsWithWhatRestsOrIsNotThere) {
  for (const MotionVerdict against : {MotionVerdict::kRested, MotionVerdict::kNothing}) {
    Existence existence;
    existence.addSpeed(6, 1);
    const double before = existence.probability();
    for (int frame = 0; frame < 5; ++frame) existence.addVerdict(MotionVerdict::kMoved);
    const double moved = existence.probability();
    EXPECT_GT(moved, 0.95);
    for (int frame = 0; frame < 3; ++frame) existence.addVerdict(MotionVerdict::kUntold);
    EXPECT_EQ(existence.probability(), moved);
    for (int frame = 0; frame < 30; ++frame) existence.addVerdict(against);
    EXPECT_LT(existence.probability(), moved);
    EXPECT_GT(moved, before);
  }
}

TEST(Existence, CountsSuccessiveFramesOfOneVerdictLessAndLess) {
  Existence existence;
  existence.addSpeed(3, 1);
  const auto logOdds = [&] { return std::log(existence.probability() / (1 - existence.probability())); };
  const double none = logOdds();
  existence.addVerdict(MotionVerdict::kRested);
  const double one = logOdds();
  existence.addVerdict(MotionVerdict::kRested);
  EXPECT_NEAR(logOdds() - one, (one - none) / 2, 1e-9);
}

}  // namespace
}  // namespace motorcade
