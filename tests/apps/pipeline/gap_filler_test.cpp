#include "apps/pipeline/gap_filler.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

constexpr std::int64_t kGapSecond_ns = 1'000'000'000, kHour_ns = 3600 * kGapSecond_ns;

/// A camera that goes forward by ten meters a second, ten frames a second.
FrameEstimate estimateAt(std::int64_t frame) {
  FrameEstimate estimate;
  estimate.head.frame = {frame};
  estimate.head.stamp = {frame * kGapSecond_ns / 10};
  estimate.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {0, 0, static_cast<double>(frame)});
  return estimate;
}

double wayTo_m(const GapFiller& filler, std::int64_t stamp_ns) { return filler.predict({stamp_ns}).translation().z(); }

TEST(GapFiller, PredictsASteadyMotionForASecond) {
  GapFiller filler;
  filler.published(estimateAt(0), true);
  filler.published(estimateAt(1), true);
  EXPECT_NEAR(wayTo_m(filler, 3 * kGapSecond_ns / 10), 3, 1e-9);
  EXPECT_NEAR(wayTo_m(filler, 11 * kGapSecond_ns / 10), 11, 1e-9);
  EXPECT_NEAR(wayTo_m(filler, kHour_ns), 11, 1e-9);
  EXPECT_NEAR(wayTo_m(filler, -kHour_ns), -10, 1e-9);
}

TEST(GapFiller, InterpolatesBetweenFinalPoses) {
  GapFiller filler;
  filler.published(estimateAt(0), true);
  filler.fill({droppedFrame({1}, {kGapSecond_ns / 10})});
  filler.published(estimateAt(2), true);
  const auto finals = filler.completed({estimateAt(0), estimateAt(2)});
  ASSERT_EQ(finals.size(), 3u);
  EXPECT_NEAR(finals[1].T_world_cam.translation().z(), 1, 1e-9);
}

TEST(GapFiller, TakesTheFirstMotionToHaveGoneOnBefore) {
  GapFiller filler;
  filler.fill({droppedFrame({0}, {0}), droppedFrame({1}, {kGapSecond_ns / 10})});
  for (const std::int64_t frame : {2, 3, 4}) filler.published(estimateAt(frame), true);
  const auto finals = filler.completed({estimateAt(2)});
  ASSERT_EQ(finals.size(), 3u);
  EXPECT_NEAR(finals[0].T_world_cam.translation().z(), 0, 1e-9);
  EXPECT_NEAR(finals[1].T_world_cam.translation().z(), 1, 1e-9);
}

}  // namespace
}  // namespace motorcade
