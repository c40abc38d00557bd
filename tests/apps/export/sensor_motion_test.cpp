#include "apps/export/sensor_motion.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace motorcade {
namespace {

constexpr int kHere = 10;
constexpr std::int64_t kGap_ns = 100'000'000;

/// Twenty frames of a sensor that gathers speed in a curve; exact to the third order about frame 10.
class SensorMotionWay : public testing::Test {
 protected:
  SensorMotionWay() {
    twist_ << 12, 0.3, -0.1, 0.01, 0.02, 0.3;
    change_ << 2, 0.1, 0, 0, 0.01, 0.1;
    for (int i = 0; i < 20; ++i) {
      const double t_s = 0.1 * (i - kHere);
      const SE3 T_here_now = SE3::exp(twist_ * t_s + change_ * (t_s * t_s / 2));
      way_.push_back({{.frame = {i}, .stamp = {kGap_ns * i}}, T_world_here_ * T_here_now});
    }
  }

  Vector6d twist_, change_;
  SE3 T_world_here_{expSO3({0.1, 0.2, 1.3}), {5, 6, 7}};
  std::vector<TimedPose> way_;
};

TEST_F(SensorMotionWay, IsTheSlopeAndTheBendOfTheWay) {
  const auto motion = sensorMotionAt(way_, kHere);
  ASSERT_TRUE(motion);
  EXPECT_LT((motion->twist - twist_).norm(), 1e-9);
  EXPECT_LT((motion->change - change_).norm(), 1e-8);
}

TEST_F(SensorMotionWay, PosesThatWereRejectedOrAreOfAnotherSegmentDoNotCount) {
  way_[kHere - 1].head.status = FrameStatus::kRejected;
  way_[kHere - 1].T_world_sensor = SE3(Eigen::Matrix3d::Identity(), {900, 0, 0});
  for (int i = kHere + 2; i < 20; ++i) {
    way_[i].head.segment = 1;
    way_[i].T_world_sensor = SE3();
  }
  const auto motion = sensorMotionAt(way_, kHere);
  ASSERT_TRUE(motion);
  EXPECT_LT((motion->twist - twist_).norm(), 1e-9);
}

TEST_F(SensorMotionWay, TwoFramesAreTooFew) {
  EXPECT_TRUE(sensorMotionAt(way_, 0));
  for (std::size_t i = 2; i < way_.size(); ++i) way_[i].head.segment = 1;
  EXPECT_FALSE(sensorMotionAt(way_, 0));
  EXPECT_FALSE(sensorMotionAt({way_[0]}, 0));
}

TEST_F(SensorMotionWay, ARejectedFrameHasNone) {
  way_[kHere].head.status = FrameStatus::kRejected;
  EXPECT_FALSE(sensorMotionAt(way_, kHere));
}

TEST_F(SensorMotionWay, NeighborsCountAtLowRatesAndTheirSilenceDoesNot) {
  for (int i = 0; i < 20; ++i) way_[i].head.stamp = {4 * kGap_ns * i};
  const auto slow = sensorMotionAt(way_, kHere);
  ASSERT_TRUE(slow);
  EXPECT_NEAR(slow->twist[0], twist_[0] / 4, 1e-9);
  for (int i = 0; i < 20; ++i) way_[i].head.stamp = {40 * kGap_ns * i};
  EXPECT_FALSE(sensorMotionAt(way_, kHere));
}

TEST_F(SensorMotionWay, EqualTimesGiveNone) {
  for (TimedPose& pose : way_) pose.head.stamp = {};
  EXPECT_FALSE(sensorMotionAt(way_, kHere));
}

/// A sensor on a curve that tightens, and an object on a circle that gathers speed; both at any time.
struct Scene {
  Vector6d twist, change;
  double speed_mps = 8, along_mps2 = 1.5, yaw_rate_radps = 0.4, yaw_radps2 = -0.3;
  Eigen::Vector3d center_body{0.8, -0.3, 0.7};

  Scene() {
    twist << 10, 0.5, 0.2, 0.05, -0.1, 0.4;
    change << -1, 0.2, 0.1, 0.1, 0.2, -0.3;
  }
  SE3 sensorAt(double t_s) const {
    return SE3(expSO3({0.1, -0.2, 0.5}), {3, 1, 1.5}) * SE3::exp(twist * t_s + change * (t_s * t_s / 2));
  }
  /// Travels along the body's x axis. Midpoint steps: their error is beyond the third order.
  SE3 bodyAt(double t_s) const {
    constexpr int kSteps = 200;
    const Eigen::Matrix3d R_start = expSO3({0.05, 0.1, 0.3});
    const auto yawAt = [&](double s) { return yaw_rate_radps * s + yaw_radps2 * s * s / 2; };
    Eigen::Vector3d place(20, 4, 0.2);
    for (int i = 0; i < kSteps; ++i) {
      const double s = t_s * (i + 0.5) / kSteps;
      place += R_start * expSO3({0, 0, yawAt(s)}).col(0) * ((speed_mps + along_mps2 * s) * t_s / kSteps);
    }
    return {R_start * expSO3({0, 0, yawAt(t_s)}), place};
  }
  SE3 boxSeenAt(double t_s) const {
    return sensorAt(t_s).inverse() * bodyAt(t_s) * SE3(Eigen::Matrix3d::Identity(), center_body);
  }
  ObjectEstimate object() const {
    ObjectEstimate object;
    object.T_world_body = bodyAt(0);
    object.velocity_world_mps = speed_mps * object.T_world_body.rotation().col(0);
    object.yaw_rate_radps = yaw_rate_radps;
    object.acceleration = {.along_mps2 = along_mps2, .yaw_radps2 = yaw_radps2};
    object.cuboid = ObjectBox{.center_body = center_body, .size_m = {4, 2, 1.5}};
    return object;
  }
};

TEST(RelativeMotion, IsTheDerivativeOfWhatTheSensorSees) {
  constexpr double kStep_s = 1e-3;
  constexpr double kTol = 1e-4;  // error of central differences with this step
  const Scene scene;
  const RelativeMotion motion =
      relativeMotion(scene.object(), scene.sensorAt(0).inverse(), {.twist = scene.twist, .change = scene.change});
  const SE3 before = scene.boxSeenAt(-kStep_s), now = scene.boxSeenAt(0), after = scene.boxSeenAt(kStep_s);
  EXPECT_LT((motion.T_sensor_box.translation() - now.translation()).norm(), 1e-12);
  const Eigen::Vector3d velocity = (after.translation() - before.translation()) / (2 * kStep_s);
  EXPECT_LT((motion.velocity_mps - velocity).norm(), kTol);
  const Eigen::Vector3d acceleration =
      (after.translation() - 2 * now.translation() + before.translation()) / (kStep_s * kStep_s);
  ASSERT_TRUE(motion.acceleration_mps2);
  EXPECT_LT((*motion.acceleration_mps2 - acceleration).norm(), 10 * kTol);
  const Eigen::Vector3d turn = logSO3(before.rotation().transpose() * after.rotation()) / (2 * kStep_s);
  EXPECT_LT((motion.turn_radps - turn).norm(), kTol);
}

TEST(RelativeMotion, WhatKeepsItsDistanceHasNone) {
  ObjectEstimate object;
  object.T_world_body = SE3(Eigen::Matrix3d::Identity(), {30, 0, 0});
  object.velocity_world_mps = {15, 0, 0};
  Vector6d twist = Vector6d::Zero();
  twist[0] = 15;
  const RelativeMotion motion = relativeMotion(object, SE3(), {.twist = twist});
  EXPECT_LT(motion.velocity_mps.norm(), 1e-12);
  EXPECT_FALSE(motion.acceleration_mps2) << "nothing tells the object's own";
}

TEST(RelativeMotion, AnObjectThatStandsHeadsWhereItFaces) {
  ObjectEstimate object;
  object.T_world_body = SE3(expSO3({0, 0, 1}), Eigen::Vector3d::Zero());
  object.velocity_world_mps = {0, 0.01, 0};
  EXPECT_LT((directionOf(object) - Eigen::Vector3d(std::cos(1), std::sin(1), 0)).norm(), 1e-12);
  object.velocity_world_mps = {0, 5, 0};
  EXPECT_LT((directionOf(object) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
}

}  // namespace
}  // namespace motorcade
