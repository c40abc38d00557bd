#include "apps/evaluate/existence_measures.hpp"

#include <gtest/gtest.h>

#include "tests/apps/compared_frame_by_hand.hpp"

namespace motorcade {
namespace {

/// One frame: a row on a car for each probability of `real`, and a row on nothing for each of `false_rows`.
std::vector<ComparedFrame> frameOf(const std::vector<double>& real, const std::vector<double>& false_rows) {
  ComparedFrame frame;
  const auto add = [&](double probability, int object) {
    frame.rows.push_back(test::rowByHand(static_cast<int>(frame.rows.size()), object, 20));
    frame.rows.back().row.object.existence_probability = probability;
  };
  for (const double probability : real) {
    frame.objects.push_back(test::labelByHand(static_cast<int>(frame.objects.size()), 20));
    add(probability, static_cast<int>(frame.objects.size()) - 1);
  }
  for (const double probability : false_rows) add(probability, -1);
  return {frame};
}

TEST(ExistenceErrors, CountTheRealRowsOfEachTenth) {
  const ExistenceErrors errors = existenceErrors(frameOf({1, 0.95, 0.75}, {0.71, 0.05, 0.79}));
  EXPECT_EQ(errors.rows(), 6);
  EXPECT_EQ(errors.tenths[9].rows, 2);
  EXPECT_EQ(errors.tenths[9].real, 2);
  EXPECT_EQ(errors.tenths[7].rows, 3);
  EXPECT_EQ(errors.tenths[7].real, 1);
  EXPECT_NEAR(errors.tenths[7].claimed(), 0.75, 1e-12);
  EXPECT_EQ(errors.tenths[0].rows, 1);
  EXPECT_NEAR(errors.largestGap(1), 0.75 - 1.0 / 3, 1e-12);
  EXPECT_NEAR(errors.largestGap(4), 0, 1e-12);
}

TEST(ExistenceErrors, GiveTheBrierScore) {
  EXPECT_NEAR(existenceErrors(frameOf({0.9}, {0.5})).brier(), (0.01 + 0.25) / 2, 1e-12);
  EXPECT_EQ(existenceErrors({}).brier(), 0);
}

TEST(ExistenceErrors, TakeWhatNeverMovesForFalse) {
  auto frames = frameOf({0.9}, {});
  frames[0].objects[0].ever_moves = false;
  EXPECT_EQ(existenceErrors(frames).tenths[9].real, 0);
}

TEST(ExistenceErrors, LeaveOutWhatTheLabelsLeaveOpen) {
  auto frames = frameOf({}, {0.9});
  frames[0].rows[0].in_ignored_area = true;
  EXPECT_EQ(existenceErrors(frames).rows(), 0);
}

}  // namespace
}  // namespace motorcade
