#include "frontend/shape/existence.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr FrameId kFirst{0};

void addVerdicts(Existence& existence, int first, int frames, MotionVerdict verdict) {
  for (int frame = first; frame < first + frames; ++frame) existence.addVerdict(FrameId{frame}, verdict);
}

/// Log odds to which the evidence adds up, before they are calibrated.
double summed(double probability) {
  const double log_odds = std::log(probability / (1 - probability));
  return log_odds > 0 ? log_odds / 1.4 : log_odds;
}

TEST(Existence, IsUndecidedBeforeAnythingIsSeen) {
  Existence existence;
  existence.addSpeed(0, 1e3);
  EXPECT_NEAR(existence.probability(), 0.5, 0.01);
}

/// Expects the likelihood of a speed among those of traffic, Gaussian with 10 m/s, over that as an error alone.
TEST(Existence, OfASpeedIsItsLikelihoodInTrafficAgainstRest) {
  Existence existence;
  existence.addSpeed(6, 3);
  const double in_traffic = std::exp(-0.5 * 36 / (100 + 9)) / std::sqrt(100 + 9), at_rest = std::exp(-0.5 * 36 / 9) / 3;
  EXPECT_NEAR(summed(existence.probability()), std::log(in_traffic / at_rest), 1e-9);
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
  EXPECT_GT(existence.probability(), 0.9);
  EXPECT_LT(existence.probability(), 0.95);
}

/// One in six tracks is real although all evidence speaks against it.
TEST(Existence, IsNeverSureThatThereIsNothing) {
  Existence existence;
  existence.addSettledSpeed(0.1, 0.1);
  EXPECT_NEAR(existence.settledProbability(kFirst), 1.0 / 6, 0.01);
  addVerdicts(existence, 0, 9, MotionVerdict::kRested);
  EXPECT_NEAR(existence.settledProbability(kFirst), 1.0 / 6, 0.01);
}

TEST(Existence, OfSettledEstimatesOfRestTheSurestCounts) {
  Existence existence;
  existence.addSettledSpeed(0.2, 8);
  const double unsure = existence.settledProbability(kFirst);
  existence.addSettledSpeed(0.2, 2);
  const double surer = existence.settledProbability(kFirst);
  EXPECT_LT(surer, unsure - 0.1);
  existence.addSettledSpeed(0.2, 8);
  EXPECT_EQ(existence.settledProbability(kFirst), surer);
  existence.addSettledSpeed(6, 1);
  const double moved = existence.settledProbability(kFirst);
  EXPECT_GT(moved, 0.85);
  existence.addSettledSpeed(0.1, 0.1);
  EXPECT_EQ(existence.settledProbability(kFirst), moved) << "it has stopped";
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
  EXPECT_GT(existence.settledProbability(kFirst), 0.8);
}

/// Hindsight shows that the first estimate was wrong.
TEST(Existence, IsSettledByWhatIsSettledAlone) {
  Existence existence;
  existence.addSpeed(6, 0.5);
  existence.addSettledSpeed(0.5, 0.5);
  EXPECT_GT(existence.probability(), 0.8);
  EXPECT_LT(existence.settledProbability(kFirst), 0.2);
}

TEST(Existence, GrowsWithWhatMovesAndFallsWithWhatRestsOrIsNotThere) {
  for (const MotionVerdict against : {MotionVerdict::kRested, MotionVerdict::kOnRoad, MotionVerdict::kWithin,
                                      MotionVerdict::kBehind, MotionVerdict::kRepeats, MotionVerdict::kNothing}) {
    Existence existence;
    existence.addSpeed(6, 1);
    addVerdicts(existence, 0, 5, MotionVerdict::kMoved);
    const double moved = existence.probability();
    EXPECT_GT(moved, 0.95);
    addVerdicts(existence, 5, 3, MotionVerdict::kUntold);
    EXPECT_EQ(existence.probability(), moved);
    addVerdicts(existence, 8, 30, against);
    EXPECT_LT(existence.probability(), moved);
  }
}

/// A wrong match or two may seem to move.
TEST(Existence, GrowsLessWithAPointOrTwo) {
  Existence many, few;
  many.addSpeed(3, 1), few.addSpeed(3, 1);
  const double before = few.probability();
  many.addVerdict(kFirst, MotionVerdict::kMoved), few.addVerdict(kFirst, MotionVerdict::kHardly);
  EXPECT_GT(few.probability(), before);
  EXPECT_GT(many.probability(), few.probability() + 0.03);
}

/// Three points agree with some motion, whatever they do.
TEST(Existence, AsksForMoreThanThreeFollowedPointsInSomeFrame) {
  Existence few, more;
  for (Existence* existence : {&few, &more}) {
    existence->addSpeed(8, 0.5), existence->addSettledSpeed(8, 0.5);
    existence->addVerdict(kFirst, MotionVerdict::kHardly);
    for (const std::size_t points : {3, 0, 3}) existence->addFollowed(points);
  }
  EXPECT_LT(few.probability(), 0.5);
  EXPECT_LT(few.settledProbability(kFirst), 0.5);
  more.addFollowed(4), more.addFollowed(0);
  EXPECT_GT(more.probability(), 0.8);
  EXPECT_GT(more.settledProbability(kFirst), 0.8);
}

TEST(Existence, OfASlowTrackThatNoImageEverToldOfIsLow) {
  const auto probability = [](double speed_mps, int untold, bool told) {
    Existence existence;
    existence.addSettledSpeed(speed_mps, 0.1);
    addVerdicts(existence, 0, untold, MotionVerdict::kUntold);
    if (told) addVerdicts(existence, untold, 1, MotionVerdict::kHardly);
    EXPECT_EQ(existence.probability() < 0.5, existence.settledProbability(kFirst) < 0.5) << speed_mps;
    return existence.probability();
  };
  EXPECT_GT(probability(1.2, 5, false), 0.5);
  EXPECT_LT(probability(1.2, 6, false), 0.2);
  EXPECT_GT(probability(1.2, 20, true), 0.5);
  EXPECT_GT(probability(3, 20, false), 0.5) << "faster than a walk";
}

TEST(Existence, CountsSuccessiveFramesOfOneVerdictLessAndLess) {
  Existence existence;
  existence.addSpeed(15, 0.1);
  const double none = summed(existence.probability());
  existence.addVerdict(FrameId{0}, MotionVerdict::kRested);
  const double one = summed(existence.probability());
  existence.addVerdict(FrameId{1}, MotionVerdict::kRested);
  EXPECT_NEAR(summed(existence.probability()) - one, (one - none) / 2, 1e-9);
}

/// The odds of one in nine.
TEST(Existence, BeginsWithADoubtOfWhatWasBornSlow) {
  Existence existence;
  existence.addSpeed(15, 0.1);
  const double before = summed(existence.probability());
  existence.doubtSlowBirth();
  EXPECT_NEAR(before - summed(existence.probability()), std::log(9), 0.01);
  existence.addSettledSpeed(1.4, 0.1);
  EXPECT_LT(existence.settledProbability(kFirst), 0.5) << "a sure speed does not lift it";
  addVerdicts(existence, 0, 1, MotionVerdict::kMoved);
  EXPECT_GT(existence.settledProbability(kFirst), 0.5) << "an image that moved does";
}

/// A track may slip off a person to what is behind.
TEST(Existence, OfWhatWasSurelySeenHoldsBeforeTheTrackSlippedOff) {
  Existence existence;
  existence.addSettledSpeed(1.4, 0.1);
  addVerdicts(existence, 0, 10, MotionVerdict::kMoved);
  addVerdicts(existence, 10, 50, MotionVerdict::kRested);
  EXPECT_GT(existence.settledProbability(FrameId{9}), 0.95);
  EXPECT_EQ(existence.settledProbability(FrameId{0}), existence.settledProbability(FrameId{9}));
  EXPECT_LT(existence.settledProbability(FrameId{59}), 0.5);
}

TEST(Existence, OfWhatWasNeverSurelySeenIsOneForAllItsFrames) {
  Existence existence;
  existence.addSettledSpeed(6, 1);
  addVerdicts(existence, 0, 1, MotionVerdict::kHardly);
  addVerdicts(existence, 1, 20, MotionVerdict::kRested);
  EXPECT_LT(existence.settledProbability(FrameId{0}), 0.2);
  EXPECT_EQ(existence.settledProbability(FrameId{0}), existence.settledProbability(FrameId{20}));
}

}  // namespace
}  // namespace motorcade
