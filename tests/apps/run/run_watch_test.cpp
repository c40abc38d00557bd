#include "apps/run/run_watch.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

using testing::HasSubstr;

/// Messages about a drive of 20 frames, frame by frame.
std::vector<std::string> saidOf(double speed_mps, double period_s, double stamp_unit_s, int lost_every = 100) {
  Plausibility plausibility;
  std::vector<std::string> said;
  for (int frame = 0; frame < 20; ++frame) {
    FrameEstimate estimate;
    estimate.head.frame.value = frame;
    estimate.head.stamp.ns = std::llround(1e9 * frame * period_s / stamp_unit_s);
    estimate.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {0, 0, speed_mps * period_s * frame});
    if (frame % lost_every == lost_every - 1) estimate.head.status = FrameStatus::kLost;
    if (const auto sentence = plausibility.observe(estimate)) {
      EXPECT_LE(frame, 10);
      said.push_back(*sentence);
    }
  }
  return said;
}

TEST(Plausibility, IsQuietOnAnOrdinaryDrive) {
  for (const double period_s : {0.01, 0.1, 1.0}) {
    EXPECT_TRUE(saidOf(0, period_s, 1).empty());
    EXPECT_TRUE(saidOf(40, period_s, 1).empty());
  }
}

TEST(Plausibility, TellsTimesInAnotherUnitOnce) {
  const auto milliseconds = saidOf(10, 0.1, 1e-3), thousands = saidOf(10, 0.1, 1e3);
  ASSERT_EQ(milliseconds.size(), 1U);
  EXPECT_THAT(milliseconds[0], HasSubstr("pairs are 100 s apart"));
  ASSERT_FALSE(thousands.empty());
  EXPECT_THAT(thousands[0], HasSubstr("pairs are 0.0001 s apart"));
}

TEST(Plausibility, TellsARateThatIsTenTimesTooHigh) {
  const auto said = saidOf(12, 0.1, 10);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said[0], HasSubstr("would move at 120 m/s"));
}

TEST(Plausibility, SpeedsOfFramesThatAreNotMeasuredTellNothing) { EXPECT_TRUE(saidOf(12, 0.1, 10, 3).empty()); }

}  // namespace
}  // namespace motorcade
