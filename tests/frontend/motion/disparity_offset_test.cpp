#include "frontend/motion/disparity_offset.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;
using test::Noise;

constexpr int kWindow = 5;  // frames from one measurement to the next

SE3 trueWindowMotion() {
  Vector6d xi;
  xi << 0.1, 0, -5, 0, 0.05, 0;
  return SE3::exp(xi);  // T_now_then over a window at 10 m/s
}

/// Points at rest as the rig sees them: its disparities lack `offset_px`; those of `in_use_px` are already added.
std::vector<StereoCorrespondence> window(double offset_px, double in_use_px, Noise& noise) {
  const Eigen::Vector3d error(0, 0, in_use_px - offset_px);
  std::vector<StereoCorrespondence> points;
  while (points.size() < 200) {
    const Eigen::Vector3d p = test::streetPoint(noise, 9, 60);
    const auto then = test::look(p, noise), now = test::look(trueWindowMotion() * p, noise);
    if (then && now)
      points.push_back({*then + error, test::kObservationSigma_px, *now + error, test::kObservationSigma_px});
  }
  return points;
}

/// The ego-motion estimated so far is a little off.
SE3 estimatedMotion(Noise& noise) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(0.03), Eigen::Vector3d::Constant(0.002);
  return trueWindowMotion() * SE3::exp(noise.gaussian(sigma));
}

void drive(DisparityOffsetEstimator& estimator, double offset_px, int windows, Noise& noise) {
  for (int w = 0; w < windows; ++w) {
    estimator.learn(window(offset_px, estimator.offset_px(), noise), estimatedMotion(noise));
    for (int frame = 0; frame < kWindow; ++frame) estimator.advance();
  }
}

class DisparityOffsetSeeds : public testing::TestWithParam<int> {};

TEST_P(DisparityOffsetSeeds, ConvergesToTheRigsOffset) {
  Noise noise(static_cast<std::uint64_t>(GetParam()));
  DisparityOffsetEstimator estimator({}, kRig);
  drive(estimator, 0.2, 60, noise);
  EXPECT_NEAR(estimator.offset_px(), 0.2, 0.05);  // the posterior's three sigmas after 300 frames
  EXPECT_LT(estimator.sigma_px(), 0.02);
}

TEST_P(DisparityOffsetSeeds, StaysNearZeroOnAGoodRig) {
  Noise noise(static_cast<std::uint64_t>(100 + GetParam()));
  DisparityOffsetEstimator estimator({}, kRig);
  for (int w = 0; w < 60; ++w) {
    drive(estimator, 0, 1, noise);
    EXPECT_LT(std::abs(estimator.offset_px()), 0.05);  // at all times: a depth of 60 m moves by less than half a meter
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, DisparityOffsetSeeds, testing::Range(0, 5));

TEST(DisparityOffset, APriorOfZeroSwitchesItOff) {
  Noise noise(1);
  DisparityOffsetEstimator::Params params;
  params.prior_sigma_px = 0;
  DisparityOffsetEstimator estimator(params, kRig);
  drive(estimator, 0.2, 10, noise);
  EXPECT_EQ(estimator.offset_px(), 0);
}

TEST(DisparityOffset, ACameraThatStandsLearnsNothing) {
  Noise noise(1);
  DisparityOffsetEstimator estimator({}, kRig);
  const auto points = window(0.2, 0, noise);
  estimator.learn(points, SE3{Eigen::Matrix3d::Identity(), {0, 0, 0.5}});
  EXPECT_EQ(estimator.sigma_px(), DisparityOffsetEstimator::Params{}.prior_sigma_px);
  estimator.learn(std::span(points).first(20), trueWindowMotion());  // too few points
  EXPECT_EQ(estimator.sigma_px(), DisparityOffsetEstimator::Params{}.prior_sigma_px);
}

TEST(DisparityOffset, WindowsFollowOneAnother) {
  DisparityOffsetEstimator::Params params;
  params.window_frames = 4;
  const DisparityOffsetEstimator estimator(params, kRig);
  EXPECT_EQ(estimator.windowStart(12), 8);
  for (const int now : {9, 10, 11}) EXPECT_FALSE(estimator.windowStart(now));
}

TEST(DisparityOffset, FollowsTheEstimateAtABoundedRate) {
  Noise noise(1);
  const DisparityOffsetEstimator::Params params;
  DisparityOffsetEstimator estimator(params, kRig);
  for (int w = 0; w < 5; ++w) estimator.learn(window(0.2, 0, noise), trueWindowMotion());
  double before = estimator.offset_px();
  for (int frame = 0; frame < 100; ++frame) {
    const double change = estimator.advance();
    EXPECT_LE(std::abs(change), params.max_rate_px);
    EXPECT_DOUBLE_EQ(estimator.offset_px(), before + change);
    before = estimator.offset_px();
  }
  EXPECT_GT(before, 0.1);             // half of the truth at the least, against the prior
  EXPECT_EQ(estimator.advance(), 0);  // arrived
}

}  // namespace
}  // namespace motorcade
