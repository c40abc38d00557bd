#include "apps/export/sensor_motion.hpp"

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

}  // namespace
}  // namespace motorcade
