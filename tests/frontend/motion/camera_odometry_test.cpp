#include "frontend/motion/camera_odometry.hpp"

#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

const SE3 kStep(expSO3({0, 0.01, 0}), {0, 0, 1});  // T_previous_now in 0.1 s

StereoFrame frameAt(int number, std::int64_t ms) {
  StereoFrame frame;
  frame.frame = {number};
  frame.stamp = {ms * 1'000'000};
  return frame;
}

/// Points at rest, seen before and after a motion, and every tenth that is new or was not found.
struct Views {
  std::vector<std::optional<KnownPoint>> known;
  std::vector<std::optional<StereoObservation>> observed;

  Views(int points, const SE3& T_previous_now, std::uint64_t seed) {
    test::Noise noise(seed);
    while (static_cast<int>(known.size()) < points) {
      const Eigen::Vector3d p = test::streetPoint(noise, 6, 40);
      const auto o = test::lookTwice(p, T_previous_now.inverse() * p, noise);
      if (!o) continue;
      known.push_back(KnownPoint{kRig.triangulate(*kRig.project(p)), test::triangulationCovariance(*kRig.project(p)),
                                 kRig.project(p)->z(), false});
      observed.emplace_back(StereoObservation{o->uvd_px.cast<float>(), o->sigma_px.cast<float>()});
      if (known.size() % 10 == 0) known.back().reset();
      if (known.size() % 10 == 5) observed.back().reset();
    }
  }
};

TEST(CameraOdometry, MeasuresTheMotionAndLeavesATrail) {
  CameraOdometry odometry({}, kRig);
  const Views views(200, kStep, 1);
  EXPECT_FALSE(odometry.motionKnown());
  EXPECT_THAT(odometry(frameAt(0, 0), views.known, views.observed).T_previous_now, test::IsNearPose(SE3{}, 0.0));
  EXPECT_FALSE(odometry.motionKnown());
  const CameraMotion motion = odometry(frameAt(1, 100), views.known, views.observed);
  EXPECT_EQ(motion.status, FrameStatus::kGood);
  EXPECT_THAT(motion.T_previous_now, test::IsNearPose(kStep, 0.02));  // five of its standard deviations
  EXPECT_THAT(odometry.trail().find(0)->T_then_now, test::IsNearPose(motion.T_previous_now, 1e-12));
  EXPECT_TRUE(odometry.motionKnown());
  ASSERT_EQ(motion.inliers.size(), views.observed.size());
  int inliers = 0;
  for (std::size_t i = 0; i < motion.inliers.size(); ++i) {
    EXPECT_TRUE(!motion.inliers[i] || (views.known[i] && views.observed[i]));
    inliers += motion.inliers[i];
  }
  EXPECT_EQ(inliers, motion.inlier_count);
  EXPECT_GT(inliers, 150);
}

TEST(CameraOdometry, PredictsTheVelocityOfTheFrameBefore) {
  CameraOdometry odometry({}, kRig);
  EXPECT_THAT(odometry.predict({0}), test::IsNearPose(SE3{}, 0.0));
  odometry(frameAt(0, 0), {}, {});
  const Views views(200, kStep, 2);
  const SE3 measured = odometry(frameAt(1, 100), views.known, views.observed).T_previous_now;
  EXPECT_THAT(odometry.predict({200'000'000}), test::IsNearPose(measured, 1e-9));
  EXPECT_THAT(odometry.predict({300'000'000}), test::IsNearPose(measured * measured, 1e-9));
}

TEST(CameraOdometry, WithTooFewPointsTheMotionIsPredictedAndItsCovarianceWide) {
  CameraOdometry odometry({}, kRig);
  const Views views(200, kStep, 3);
  odometry(frameAt(0, 0), {}, {});
  const CameraMotion measured = odometry(frameAt(1, 100), views.known, views.observed);
  const CameraMotion lost = odometry(frameAt(2, 200), {}, {});
  EXPECT_EQ(lost.status, FrameStatus::kLost);
  EXPECT_THAT(lost.T_previous_now, test::IsNearPose(measured.T_previous_now, 1e-9));
  for (int i = 0; i < 6; ++i) EXPECT_GT(lost.covariance(i, i), 100 * measured.covariance(i, i));
}

TEST(CameraOdometry, AFrameAtTheTimeOfTheOneBeforeIsPredictedToStand) {
  CameraOdometry odometry({}, kRig);
  const Views views(200, kStep, 4);
  odometry(frameAt(0, 0), {}, {});
  odometry(frameAt(1, 0), views.known, views.observed);
  EXPECT_THAT(odometry.predict({100'000'000}), test::IsNearPose(SE3{}, 0.0));
}

}  // namespace
}  // namespace motorcade
