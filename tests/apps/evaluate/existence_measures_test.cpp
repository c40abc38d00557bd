#include "apps/evaluate/measures/existence_measures.hpp"

#include <gtest/gtest.h>

#include "tests/apps/evaluate/compared_frame_by_hand.hpp"

namespace motorcade {
namespace {

using test::labelByHand;
using test::rowByHand;

constexpr double kRounding = 1e-12;  // of sums of some hundred numbers of about one

/// A label that moves at some time, and one of a parked car; rows are added to them by hand.
ComparedFrame frameWithoutRows() {
  ComparedFrame frame;
  frame.objects = {labelByHand(7, 20), labelByHand(8, 25)};
  frame.objects[1].counted = frame.objects[1].moving = frame.objects[1].ever_moves = false;
  return frame;
}

constexpr int kMover = 0, kParked = 1, kNoLabel = -1;

void addRow(ComparedFrame& frame, int object, double probability) {
  frame.rows.push_back(rowByHand(static_cast<int>(frame.rows.size()), object, 20));
  frame.rows.back().row.object.existence_probability = probability;
}

TEST(ExistenceErrors, CountRowsByTheTenthOfTheirProbability) {
  ComparedFrame frame = frameWithoutRows();
  for (const double probability : {0.0, 0.55, 0.59, 0.9, 1.0}) addRow(frame, kMover, probability);
  const Reliability errors = existenceErrors({frame});
  EXPECT_EQ(errors.rows(), 5);
  EXPECT_EQ(errors.tenths[0].rows, 1);
  EXPECT_EQ(errors.tenths[5].rows, 2);
  EXPECT_NEAR(errors.tenths[5].claimed(), 0.57, kRounding);
  EXPECT_EQ(errors.tenths[9].rows, 2) << "what is sure belongs to the last one";
}

TEST(ExistenceErrors, CallRealWhatIsOnALabelThatMovesAtSomeTime) {
  ComparedFrame frame = frameWithoutRows();
  frame.objects[kMover].moving = false;  // it waits in this frame
  for (const int object : {kMover, kParked, kNoLabel}) addRow(frame, object, 0.75);
  const Reliability errors = existenceErrors({frame});
  EXPECT_EQ(errors.tenths[7].rows, 3);
  EXPECT_EQ(errors.tenths[7].hits, 1);
  EXPECT_NEAR(errors.tenths[7].shareOfHits(), 1.0 / 3, kRounding);
}

TEST(ExistenceErrors, BrierScoreIsTheMeanSquaredDifferenceOverAllFrames) {
  ComparedFrame first = frameWithoutRows(), second = frameWithoutRows();
  addRow(first, kMover, 0.8);
  addRow(first, kNoLabel, 0.6);
  addRow(second, kMover, 1);
  EXPECT_NEAR(existenceErrors({first, second}).brier(), (0.2 * 0.2 + 0.6 * 0.6) / 3, kRounding);
  EXPECT_EQ(existenceErrors({}).brier(), 0);
}

TEST(ExistenceErrors, LeaveOutRowsInIgnoredAreas) {
  ComparedFrame frame = frameWithoutRows();
  addRow(frame, kNoLabel, 0.9);
  frame.rows.back().in_ignored_area = true;
  EXPECT_EQ(existenceErrors({frame}).rows(), 0);
}

TEST(ExistenceErrors, LargestGapIsThatOfTenthsWithEnoughRows) {
  ComparedFrame frame = frameWithoutRows();
  for (int i = 0; i < 99; ++i) addRow(frame, kNoLabel, 0.95);
  EXPECT_FALSE(existenceErrors({frame}).largestGap()) << "99 rows are too few";
  for (int i = 0; i < 100; ++i) addRow(frame, i < 60 ? kMover : kNoLabel, 0.75);
  EXPECT_NEAR(existenceErrors({frame}).largestGap().value(), 0.15, kRounding);
  addRow(frame, kNoLabel, 0.95);
  EXPECT_NEAR(existenceErrors({frame}).largestGap().value(), 0.95, kRounding);
}

}  // namespace
}  // namespace motorcade
