#include "apps/evaluate/measures/belief_measures.hpp"

#include <cmath>

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

TEST(KindOfType, KnowsTheTypesOfTheLabels) {
  EXPECT_EQ(kindOfType("Van"), ObjectKind::kCar);
  EXPECT_EQ(kindOfType("Tram"), ObjectKind::kLargeVehicle);
  EXPECT_EQ(kindOfType("Cyclist"), ObjectKind::kTwoWheeler);
  EXPECT_EQ(kindOfType("Pedestrian"), ObjectKind::kPedestrian);
  EXPECT_EQ(kindOfType("Misc"), ObjectKind::kUnknown);
}

/// Twelve frames with a truck that is taken for a car until frame 10, a car whose cuboid is not known in the last
/// frame, and something whose label has no kind.
std::vector<ComparedFrame> drive() {
  std::vector<ComparedFrame> frames(12);
  for (int i = 0; i < 12; ++i) {
    frames[i].objects = {labelByHand(7, 20), labelByHand(8, 25), labelByHand(9, 10), labelByHand(10, 35)};
    frames[i].objects[0].truth.type = "Truck";
    frames[i].objects[2].truth.type = "Misc";
    for (int j = 0; j < 4; ++j) frames[i].rows.push_back(rowByHand(j, j, 20));
    if (i >= 10) frames[i].rows[0].row.object.cuboid->kind = ObjectKind::kLargeVehicle;
  }
  frames.back().rows[1].row.object.cuboid.reset();
  return frames;
}

TEST(KindErrors, CountFromATracksTenthRowOnAndBefore) {
  const KindErrors errors = kindErrors(drive(), 30);
  EXPECT_EQ(errors.before.counts.total(), 18);
  EXPECT_EQ(errors.before.counts.of(ObjectKind::kLargeVehicle, ObjectKind::kCar), 9);
  EXPECT_EQ(errors.before.counts.shareRight(), 0.5);
  EXPECT_EQ(errors.from_tenth_row.counts.total(), 6);
  EXPECT_EQ(errors.from_tenth_row.counts.of(ObjectKind::kLargeVehicle, ObjectKind::kCar), 1);
  EXPECT_EQ(errors.from_tenth_row.counts.of(ObjectKind::kLargeVehicle, ObjectKind::kLargeVehicle), 2);
  EXPECT_EQ(errors.from_tenth_row.counts.of(ObjectKind::kCar, ObjectKind::kCar), 2);
  EXPECT_EQ(errors.from_tenth_row.counts.of(ObjectKind::kCar, ObjectKind::kUnknown), 1);
  EXPECT_NEAR(errors.from_tenth_row.counts.shareRight(), 4.0 / 6, 1e-12);
}

TEST(KindErrors, CountRowsThatAreNotMeasuredAsRowsOfTheTrack) {
  auto frames = drive();
  for (int i = 0; i < 9; ++i) frames[i].rows[0].object = -1;
  const KindErrors errors = kindErrors(frames, 30);
  EXPECT_EQ(errors.before.counts.total(), 9);
  EXPECT_EQ(errors.from_tenth_row.counts.total(), 6);
}

constexpr double kRoundingOfLogs = 1e-12;

TEST(KindRows, LogLossIsThatOfRightOrWrong) {
  KindRows rows;
  EXPECT_EQ(rows.logLoss(), 0);
  rows.add(ObjectKind::kCar, ObjectKind::kCar, 0.8);
  EXPECT_NEAR(rows.logLoss(), -std::log(0.8), kRoundingOfLogs);
  rows.add(ObjectKind::kTwoWheeler, ObjectKind::kCar, 0.7);
  EXPECT_NEAR(rows.logLoss(), -(std::log(0.8) + std::log(0.3)) / 2, kRoundingOfLogs);
}

TEST(KindRows, ARowThatNamesNoKindCostsATossOfACoinWhateverItsProbability) {
  for (const double probability : {0.3, 0.59}) {
    KindRows rows;
    rows.add(ObjectKind::kCar, ObjectKind::kUnknown, probability);
    EXPECT_NEAR(rows.logLoss(), std::log(2.0), kRoundingOfLogs);
    EXPECT_EQ(rows.counts.shareRight(), 0);
    EXPECT_EQ(rows.named.rows(), 0);
  }
}

TEST(KindRows, NoneIsSurerThanTheFilesDecimalsSay) {
  KindRows wrong, right;
  wrong.add(ObjectKind::kPedestrian, ObjectKind::kLargeVehicle, 1);
  right.add(ObjectKind::kPedestrian, ObjectKind::kPedestrian, 1);
  EXPECT_NEAR(wrong.logLoss(), -std::log(0.0005), kRoundingOfLogs);
  EXPECT_NEAR(right.logLoss(), 0.0005, 1e-6) << "the series' second term is half of its square";
}

TEST(KindRows, CountWrongOnesFromAProbabilityOf95PercentOn) {
  KindRows rows;
  rows.add(ObjectKind::kCar, ObjectKind::kLargeVehicle, 0.949);
  rows.add(ObjectKind::kCar, ObjectKind::kCar, 0.99);
  EXPECT_EQ(rows.shareSureWrong(), 0);
  rows.add(ObjectKind::kCar, ObjectKind::kLargeVehicle, 0.95);
  rows.add(ObjectKind::kCar, ObjectKind::kUnknown, 0.55);
  EXPECT_EQ(rows.shareSureWrong(), 0.25);
  EXPECT_EQ(rows.named.tenths[9].rows, 3);
  EXPECT_EQ(rows.named.tenths[9].hits, 1);
}

TEST(KindErrors, TakeTheProbabilitiesOfTheRows) {
  auto frames = drive();
  for (ComparedFrame& frame : frames)
    for (MatchedRow& row : frame.rows)
      if (row.row.object.cuboid) row.row.object.cuboid->kind_probability = 0.75;
  const KindRows rows = kindErrors(frames, 30).from_tenth_row;
  EXPECT_EQ(rows.named.tenths[7].rows, 5);
  EXPECT_EQ(rows.named.tenths[7].hits, 4);
  EXPECT_NEAR(rows.logLoss(), -(4 * std::log(0.75) + std::log(0.25) + std::log(0.5)) / 6, kRoundingOfLogs);
}

}  // namespace
}  // namespace motorcade
