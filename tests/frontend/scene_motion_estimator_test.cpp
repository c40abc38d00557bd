#include "frontend/scene_motion_estimator.hpp"

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

/// Messages of a frame without a single point.
SceneMotionPtr runEmpty(SceneMotionEstimator& estimate, int frame, const std::string& problem) {
  auto pair = std::make_shared<StereoFrame>();
  pair->frame = {frame};
  pair->stamp = {frame * 100'000'000};
  pair->problem = problem;
  auto features = std::make_shared<Features>();
  features->frame = pair;
  auto stereo = std::make_shared<StereoMatches>();
  stereo->features = features;
  auto flow = std::make_shared<OpticalFlow>();
  flow->features = features;
  return estimate(stereo, flow);
}

TEST(SceneMotionEstimator, EveryInputGivesOneOutputOfItsFrameAlsoWhenRejectedOrEmpty) {
  SceneMotionEstimator estimate({}, test::kRig);
  for (int frame = 0; frame < 6; ++frame) {
    const bool rejected = frame == 2 || frame == 3;
    const auto motion = runEmpty(estimate, frame, rejected ? "unreadable" : "");
    ASSERT_TRUE(motion);
    EXPECT_EQ(motion->frame, FrameId{frame});
    EXPECT_EQ(motion->stamp, Timestamp{frame * 100'000'000});
    EXPECT_EQ(motion->status, rejected ? FrameStatus::kRejected : frame == 0 ? FrameStatus::kGood : FrameStatus::kLost);
    EXPECT_TRUE(motion->points.empty());
    EXPECT_THAT(motion->T_previous_now, test::IsNearPose(SE3{}, 0.0));  // no motion was ever seen: standing still is predicted
  }
}

TEST(SceneMotionEstimator, APredictedMotionIsAsWideAsItsParametersSay) {
  const SceneMotionEstimator::Params params;
  SceneMotionEstimator estimate(params, test::kRig);
  runEmpty(estimate, 0, "");
  for (const int frame : {1, 2}) {
    const auto motion = runEmpty(estimate, frame, frame == 1 ? "" : "unreadable");
    EXPECT_DOUBLE_EQ(motion->odometry_covariance(0, 0), params.lost_sigma_m * params.lost_sigma_m);
    EXPECT_DOUBLE_EQ(motion->odometry_covariance(4, 4), params.lost_sigma_rad * params.lost_sigma_rad);
  }
}

}  // namespace
}  // namespace motorcade
