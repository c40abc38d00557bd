#include "frontend/motion/camera_odometry.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

const SE3 kOdometryStep(expSO3({0, 0.01, 0}), {0, 0, 1});  // T_seen_now in 0.1 s

StereoFrame frameAt(int number, std::int64_t ms) {
  StereoFrame frame;
  frame.head.frame = {number};
  frame.head.stamp = {ms * 1'000'000};
  return frame;
}

/// Points at rest, seen before and after a motion, and every tenth that is new or was not found.
struct Views {
  std::vector<std::optional<KnownPoint>> known;
  std::vector<std::optional<StereoObservation>> observed;

  Views(int points, const SE3& T_seen_now, std::uint64_t seed) {
    test::Noise noise(seed);
    while (static_cast<int>(known.size()) < points) {
      const Eigen::Vector3d p = test::streetPoint(noise, 6, 40);
      const auto o = test::lookTwice(p, T_seen_now.inverse() * p, noise);
      if (!o) continue;
      known.push_back(KnownPoint{kRig.triangulate(*kRig.project(p)), test::triangulationCovariance(*kRig.project(p)),
                                 kRig.project(p)->z(), PointLabel::kUnknown});
      observed.emplace_back(StereoObservation{o->uvd_px.cast<float>(), o->sigma_px.cast<float>()});
      if (known.size() % 10 == 0) known.back().reset();
      if (known.size() % 10 == 5) observed.back().reset();
    }
  }
};

/// A frame in which points are seen.
CameraMotion see(CameraOdometry& odometry, const StereoFrame& frame, const Views& views) {
  CameraMotion motion = odometry.measure(frame, views.known, views.observed, odometry.predict(frame.head.stamp));
  odometry.add(frame.head.stamp, motion);
  return motion;
}

const Views kNothingKnown(0, SE3{}, 1);

TEST(CameraOdometry, MeasuresTheMotionAndLeavesATrail) {
  CameraOdometry odometry({}, kRig);
  const Views views(200, kOdometryStep, 1);
  EXPECT_FALSE(odometry.motionKnown({0}));
  EXPECT_THAT(see(odometry, frameAt(0, 0), views).T_seen_now, test::IsNearPose(SE3{}, 0.0));
  EXPECT_FALSE(odometry.motionKnown({0}));
  const CameraMotion motion = see(odometry, frameAt(1, 100), views);
  EXPECT_EQ(motion.status, FrameStatus::kGood);
  EXPECT_THAT(motion.T_seen_now, test::IsNearPose(kOdometryStep, 0.02));  // five of its standard deviations
  EXPECT_THAT(odometry.trail().find(0)->T_then_now, test::IsNearPose(motion.T_seen_now, 1e-12));
  EXPECT_TRUE(odometry.motionKnown({200'000'000}));
  EXPECT_FALSE(odometry.motionKnown({2'000'000'000}));
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
  EXPECT_THAT(odometry.predict({0}).T_seen_now, test::IsNearPose(SE3{}, 0.0));
  see(odometry, frameAt(0, 0), kNothingKnown);
  const Views views(200, kOdometryStep, 2);
  const SE3 measured = see(odometry, frameAt(1, 100), views).T_seen_now;
  EXPECT_THAT(odometry.predict({200'000'000}).T_seen_now, test::IsNearPose(measured, 1e-9));
  EXPECT_THAT(odometry.predict({300'000'000}).T_seen_now, test::IsNearPose(measured * measured, 0.02));
}

TEST(CameraOdometry, WithTooFewPointsTheMotionIsPredictedAndItsCovarianceWide) {
  CameraOdometry odometry({}, kRig);
  const Views views(200, kOdometryStep, 3);
  see(odometry, frameAt(0, 0), kNothingKnown);
  const CameraMotion measured = see(odometry, frameAt(1, 100), views);
  const CameraMotion lost = see(odometry, frameAt(2, 200), kNothingKnown);
  EXPECT_EQ(lost.status, FrameStatus::kLost);
  EXPECT_THAT(lost.T_seen_now, test::IsNearPose(measured.T_seen_now, 1e-9));
  for (int i = 0; i < 6; ++i) EXPECT_GT(lost.covariance(i, i), 100 * measured.covariance(i, i));
}

TEST(CameraOdometry, AFrameAtTheTimeOfTheOneBeforeIsPredictedToStand) {
  CameraOdometry odometry({}, kRig);
  const Views views(200, kOdometryStep, 4);
  see(odometry, frameAt(0, 0), kNothingKnown);
  see(odometry, frameAt(1, 0), views);
  EXPECT_THAT(odometry.predict({100'000'000}).T_seen_now, test::IsNearPose(SE3{}, 0.0));
}

TEST(CameraOdometry, FramesInWhichNothingIsSeenArePassedOver) {
  CameraOdometry odometry({}, kRig);
  see(odometry, frameAt(0, 0), kNothingKnown);
  const SE3 first = see(odometry, frameAt(1, 100), Views(200, kOdometryStep, 5)).T_seen_now;
  const Odometry unseen = odometry.passOver({200'000'000});
  EXPECT_THAT(unseen.T_previous_now, test::IsNearPose(first, 0.02));
  EXPECT_EQ(odometry.trail().newest().step, 1);
  const SE3 two_steps = kOdometryStep * SE3(Eigen::Matrix3d::Identity(), {0, 0, 1.3});
  const Views views(200, two_steps, 6);
  const CameraMotion motion =
      odometry.measure(frameAt(3, 300), views.known, views.observed, odometry.predict({300'000'000}));
  EXPECT_EQ(motion.status, FrameStatus::kGood);
  EXPECT_THAT(motion.T_seen_now, test::IsNearPose(two_steps, 0.03));
  const Odometry after = odometry.add({300'000'000}, motion);
  EXPECT_THAT(unseen.T_previous_now * after.T_previous_now, test::IsNearPose(motion.T_seen_now, 1e-9));
  EXPECT_EQ(odometry.segment(), 0);
}

TEST(CameraOdometry, AStartInTheDarkIsNoMotion) {
  CameraOdometry odometry({}, kRig);
  for (int frame = 0; frame < 3; ++frame)
    EXPECT_THAT(odometry.passOver({100'000'000 * frame}).T_previous_now, test::IsNearPose(SE3{}, 0.0));
  const CameraMotion first = see(odometry, frameAt(3, 300), kNothingKnown);
  EXPECT_EQ(first.status, FrameStatus::kGood);
  EXPECT_FALSE(odometry.motionKnown({300'000'000}));
  EXPECT_THAT(see(odometry, frameAt(4, 400), Views(200, kOdometryStep, 7)).T_seen_now,
              test::IsNearPose(kOdometryStep, 0.02));
}

TEST(CameraOdometry, WhatIsNotLinkedBeginsANewSegment) {
  CameraOdometry odometry({}, kRig);
  see(odometry, frameAt(0, 0), kNothingKnown);
  see(odometry, frameAt(1, 100), Views(200, kOdometryStep, 8));
  const CameraMotion lost = see(odometry, frameAt(2, 200), kNothingKnown);
  EXPECT_EQ(lost.cause, FrameCause::kUnlinked);
  EXPECT_EQ(odometry.segment(), 0);
  see(odometry, frameAt(3, 300), Views(200, kOdometryStep, 9));
  EXPECT_EQ(odometry.segment(), 1);
}

/// Steps of a camera that goes on for six frames, and then sees points of which none was known before.
std::vector<Odometry> stepsUnlinkedAfter(CameraOdometry& odometry, const SE3& motion, int unlinked) {
  see(odometry, frameAt(0, 0), kNothingKnown);
  for (int frame = 1; frame <= 6; ++frame)
    see(odometry, frameAt(frame, 100 * frame), Views(200, motion, static_cast<std::uint64_t>(frame)));
  std::vector<Odometry> steps;
  for (int frame = 7; frame < 7 + unlinked; ++frame) {
    const StereoFrame pair = frameAt(frame, 100 * frame);
    const PredictedMotion predicted = odometry.predict(pair.head.stamp);
    steps.push_back(
        odometry.add(pair.head.stamp, odometry.measure(pair, kNothingKnown.known, kNothingKnown.observed, predicted)));
  }
  return steps;
}

TEST(CameraOdometry, ACameraThatStoodIsLinkedByThat) {
  CameraOdometry odometry({}, kRig);
  double ahead_m2 = 0;
  for (const Odometry& step : stepsUnlinkedAfter(odometry, SE3{}, 20)) {
    ASSERT_TRUE(step.told);
    EXPECT_THAT(step.told->T_previous_now, test::IsNearPose(SE3{}, 0.0));
    EXPECT_LT(step.covariance(0, 0), 0.02 * 0.02) << "it does not slide";
    ahead_m2 += step.covariance(2, 2);
  }
  EXPECT_NEAR(std::sqrt(ahead_m2), 3, 0.1) << "by 1.5 m/s^2 in two seconds";
  see(odometry, frameAt(27, 2700), Views(200, SE3{}, 30));
  EXPECT_EQ(odometry.segment(), 0);
}

TEST(CameraOdometry, WhereACameraIsThatStoodLongAgoNobodyKnows) {
  CameraOdometry odometry({}, kRig);
  const auto steps = stepsUnlinkedAfter(odometry, SE3{}, 40);
  EXPECT_TRUE(steps[29].told);
  EXPECT_FALSE(steps[30].told);
  see(odometry, frameAt(47, 4700), Views(200, SE3{}, 30));
  EXPECT_EQ(odometry.segment(), 1);
}

TEST(CameraOdometry, ThatItStoodIsKnownForThreeSeconds) {
  CameraOdometry stood({}, kRig), drove({}, kRig);
  stepsUnlinkedAfter(stood, SE3{}, 0);
  stepsUnlinkedAfter(drove, kOdometryStep, 0);
  const Timestamp soon{3'000'000'000}, late{4'000'000'000};
  EXPECT_TRUE(stood.predict(soon).stood);
  EXPECT_FALSE(stood.predict(late).stood);
  EXPECT_FALSE(drove.predict(soon).stood);
}

TEST(CameraOdometry, AFewPointsThatMoveDoNotStartACamera) {
  CameraOdometry odometry({}, kRig);
  const SE3 crept(Eigen::Matrix3d::Identity(), {0, 0, 0.05});
  stepsUnlinkedAfter(odometry, SE3{}, 0);
  EXPECT_EQ(see(odometry, frameAt(7, 700), Views(22, crept, 8)).cause, FrameCause::kFewPoints);
  CameraMotion lost;
  lost.status = FrameStatus::kLost;
  EXPECT_TRUE(odometry.add({800'000'000}, lost).told);
}

TEST(CameraOdometry, ASteadyMotionLinksForHalfASecond) {
  CameraOdometry odometry({}, kRig);
  const auto steps = stepsUnlinkedAfter(odometry, kOdometryStep, 6);
  double ahead_m2 = 0;
  for (int frame = 0; frame < 5; ++frame) {
    ASSERT_TRUE(steps[frame].told) << frame;
    EXPECT_THAT(steps[frame].told->T_previous_now, test::IsNearPose(kOdometryStep, 0.02)) << frame;
    ahead_m2 += steps[frame].covariance(2, 2);
  }
  EXPECT_NEAR(std::sqrt(ahead_m2), 0.5, 0.03) << "by braking with 4 m/s^2";
  EXPECT_FALSE(steps[5].told);
  see(odometry, frameAt(13, 1300), Views(200, kOdometryStep, 30));
  EXPECT_EQ(odometry.segment(), 1);
}

TEST(CameraOdometry, WhatIsToldAfterAnUnseenFrameIsOneStep) {
  CameraOdometry odometry({}, kRig);
  stepsUnlinkedAfter(odometry, kOdometryStep, 0);
  odometry.passOver({700'000'000});
  CameraMotion lost;
  lost.status = FrameStatus::kLost;
  lost.T_seen_now = odometry.predict({800'000'000}).T_seen_now;
  const Odometry step = odometry.add({800'000'000}, lost);
  ASSERT_TRUE(step.told);
  EXPECT_THAT(step.told->T_previous_now, test::IsNearPose(step.T_previous_now, 1e-9));
  EXPECT_NEAR(step.told->T_previous_now.translation().norm(), 1, 0.05) << "and not two";
}

TEST(CameraOdometry, AMotionThatIsNotSteadyLinksNothing) {
  CameraOdometry odometry({}, kRig);
  see(odometry, frameAt(0, 0), kNothingKnown);
  see(odometry, frameAt(1, 100), Views(200, kOdometryStep, 1));
  CameraMotion lost;
  lost.status = FrameStatus::kLost;
  EXPECT_FALSE(odometry.add({200'000'000}, lost).told);
}

TEST(CameraOdometry, NoMotionIsTakenToGoOnForLong) {
  CameraOdometry odometry({}, kRig);
  see(odometry, frameAt(0, 0), kNothingKnown);
  see(odometry, frameAt(1, 100), Views(200, kOdometryStep, 10));
  const double second_m = odometry.predict({1'100'000'000}).T_seen_now.translation().norm();
  EXPECT_NEAR(second_m, 10, 0.5);
  EXPECT_NEAR(odometry.predict({3600'000'000'000}).T_seen_now.translation().norm(), second_m, 1e-9);
}

/// Otherwise standing still would count as steady, and traffic that keeps its pace would pass for what rests.
TEST(CameraOdometry, StepsOfACameraThatMayHaveStoppedAreUncertainByTheWayThatItMayHaveGone) {
  CameraOdometry odometry({}, kRig);
  see(odometry, frameAt(0, 0), kNothingKnown);
  see(odometry, frameAt(1, 100), Views(200, kOdometryStep, 4));
  SE3 T_seen_now;
  double variance_m2 = 0;
  for (int frame = 2; frame <= 31; ++frame) {
    const Odometry step = odometry.passOver({frame * 100'000'000LL});
    T_seen_now = T_seen_now * step.T_previous_now;
    variance_m2 += step.covariance.topLeftCorner<3, 3>().trace();
  }
  const double missing_m = 30 - T_seen_now.translation().norm();  // of one that drove on at 10 m/s
  EXPECT_GT(missing_m, 19);
  EXPECT_NEAR(std::sqrt(variance_m2), missing_m, 2) << "more by what is unknown of each step";
}

TEST(CameraOdometry, AMotionThatIsOverIsNoLongerSteady) {
  CameraOdometry odometry({}, kRig);
  see(odometry, frameAt(0, 0), kNothingKnown);
  for (int i = 1; i <= 12; ++i) see(odometry, frameAt(i, 100 * i), Views(200, kOdometryStep, 10 + i));
  EXPECT_GE(odometry.predict({1'300'000'000}).steady_frames, 10);
  see(odometry, frameAt(13, 2900), kNothingKnown);
  EXPECT_EQ(odometry.predict({3'000'000'000}).steady_frames, 0);
}

/// A car hits a curb.
TEST(CameraOdometry, AJoltDoesNotGoOnInTheDark) {
  CameraOdometry odometry({}, kRig);
  const SE3 ahead(Eigen::Matrix3d::Identity(), {0, 0, 1}), jolted(expSO3({0.02, 0.04, 0}), {0, 0, 1});
  stepsUnlinkedAfter(odometry, ahead, 0);
  see(odometry, frameAt(7, 700), Views(200, jolted, 7));
  const SE3 predicted = odometry.predict({1'100'000'000}).T_seen_now;
  EXPECT_LT(predicted.log().tail<3>().norm(), 0.002);
  EXPECT_NEAR(predicted.translation().z(), 4, 0.1);
}

/// The mounting of a camera that looks down, and the motions of its car.
struct LookingDown {
  Eigen::Matrix3d R_level_cam = expSO3({-0.4, 0, 0});
  GroundPlane mounting{R_level_cam.transpose() * Eigen::Vector3d::UnitY(), 1.65};
  SE3 seen(const SE3& over_road) const { return inAxes(R_level_cam, over_road); }
};

TEST(CameraOdometry, ACameraThatLooksDownGoesOnOverTheRoad) {
  const LookingDown camera;
  const SE3 ahead = camera.seen(SE3(Eigen::Matrix3d::Identity(), {0, 0, 1}));
  for (const bool is_level_known : {false, true}) {
    CameraOdometry odometry({}, kRig);
    if (is_level_known) odometry.levelBy(camera.mounting);
    stepsUnlinkedAfter(odometry, ahead, 0);
    const Eigen::Vector3d way = camera.R_level_cam * odometry.predict({1'100'000'000}).T_seen_now.translation();
    if (is_level_known)
      EXPECT_THAT(way, test::IsNear(Eigen::Vector3d(0, 0, 5), 0.1));
    else
      EXPECT_GT(std::abs(way.y()), 1) << "it would go into the road";
  }
}

TEST(CameraOdometry, ACameraThatLooksDownMayHaveStoppedOnTheRoad) {
  const LookingDown camera;
  CameraOdometry odometry({}, kRig);
  odometry.levelBy(camera.mounting);
  const auto steps = stepsUnlinkedAfter(odometry, camera.seen(SE3(Eigen::Matrix3d::Identity(), {0, 0, 1})), 1);
  const Eigen::Matrix3d variance_m2 =
      camera.R_level_cam * steps[0].covariance.topLeftCorner<3, 3>() * camera.R_level_cam.transpose();
  EXPECT_LT(std::sqrt(variance_m2(1, 1)), 0.011);
  EXPECT_GT(std::sqrt(variance_m2(2, 2)), 0.02) << "by braking with 4 m/s^2";
}

TEST(CameraOdometry, ACarsCameraMayLookDown) {
  const LookingDown camera;
  CameraOdometry odometry({}, kRig);
  odometry.levelBy(camera.mounting);
  const SE3 step = camera.seen(kOdometryStep);
  for (int frame = 0; frame < 30; ++frame) see(odometry, frameAt(frame, 100 * frame), Views(200, step, frame));
  EXPECT_EQ(odometry.predict({3'000'000'000}).ahead_frames, 29);
  const SE3 aside(Eigen::Matrix3d::Identity(), {0.5, 0, 0});
  EXPECT_EQ(see(odometry, frameAt(30, 3000), Views(200, aside, 1)).status, FrameStatus::kLost);
}

TEST(CameraOdometry, ACarsCameraIsOneThatHasDrivenAhead) {
  CameraOdometry odometry({}, kRig);
  int frame = 0;
  for (; frame < 30; ++frame) see(odometry, frameAt(frame, 100 * frame), Views(200, kOdometryStep, frame));
  EXPECT_EQ(odometry.predict(frameAt(frame, 100 * frame).head.stamp).ahead_frames, 29);
  const SE3 aside(Eigen::Matrix3d::Identity(), {0.5, 0, 0});
  const CameraMotion refused = see(odometry, frameAt(frame, 100 * frame), Views(200, aside, 1));
  EXPECT_EQ(refused.status, FrameStatus::kLost);
  EXPECT_EQ(odometry.predict({3'500'000'000}).ahead_frames, 29);
  EXPECT_EQ(odometry.predict({9'000'000'000}).ahead_frames, 0);  // it was not seen to drive for too long
}

}  // namespace
}  // namespace motorcade
