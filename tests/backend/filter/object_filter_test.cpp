#include "backend/filter/object_filter.hpp"

#include <cmath>
#include <limits>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/decompositions.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::IsNearPose;

constexpr double kDt_s = 0.1;
Timestamp stampOf(int frame) { return {static_cast<std::int64_t>(frame * kDt_s * 1e9)}; }

Matrix6d covarianceOf(double sigma_m, double sigma_rad) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(sigma_m), Eigen::Vector3d::Constant(sigma_rad);
  return sigma.cwiseAbs2().asDiagonal();
}
const Matrix6d kMeasured = covarianceOf(0.1, 0.01);

/// A car in a bend at constant twist.
struct Bend {
  Vector6d twist{9, 0, 0, 0, 0, 0.3};
  SE3 start{expSO3({0.1, -0.2, 1}), {3, 1, 20}};
  SE3 at(int frame) const { return start * SE3::exp(frame * kDt_s * twist); }
  Eigen::Vector3d velocity_mps(int frame) const { return at(frame).rotation() * twist.head<3>(); }
};

/// Parameters of a plain filter: noise that does not adapt, and no weights.
ObjectFilter::Params plain() {
  ObjectFilter::Params params;
  params.adapt_process_noise = false;
  params.innovation_scale = 1e6;
  return params;
}

/// A filter that has followed the bend for some frames, without noise on the measurements.
ObjectFilter followed(const Bend& bend, int frames, const ObjectFilter::Params& params = plain()) {
  ObjectFilter filter(params, stampOf(0), bend.at(0), kMeasured);
  for (int frame = 1; frame < frames; ++frame) {
    filter.predict(stampOf(frame));
    filter.correct(bend.at(frame), kMeasured);
  }
  return filter;
}

TEST(ObjectFilter, FindsTheTwistFromPosesAndPredictsAlongTheBend) {
  const Bend bend;
  ObjectFilter filter = followed(bend, 60);
  EXPECT_THAT(filter.pose(), IsNearPose(bend.at(59), 1e-2));  // the prior of a car at rest has nearly died out
  EXPECT_THAT(filter.velocityWorld_mps(), IsNear(bend.velocity_mps(59), 0.05));
  EXPECT_NEAR(filter.yawRate_radps(), bend.twist[5], 2 * filter.yawRateSigma_radps());
  EXPECT_LT(filter.yawRateSigma_radps(), 0.1);  // poses to 0.01 rad
  filter.predict(stampOf(69));
  EXPECT_THAT(filter.pose(), IsNearPose(bend.at(69), 0.1));
  EXPECT_THAT(filter.velocityWorld_mps(), IsNear(bend.velocity_mps(69), 0.1));
}

TEST(ObjectFilter, AnObservationOfTheFirstFrameIsAKalmanUpdateOfThePose) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    test::Noise noise(seed);
    Vector6d sigma;
    sigma << 0.3, 0.2, 0.2, 0.03, 0.02, 0.04;
    const Matrix6d P = test::randomCovariance(noise, sigma), R = test::randomCovariance(noise, sigma);
    const Vector6d innovation = noise.correlated(R);
    const Bend bend;
    ObjectFilter filter(plain(), stampOf(0), bend.start, P);
    const auto normalized = filter.correct(bend.start * SE3::exp(innovation), R);

    const Matrix6d S = P + R, K = P * inverse(S);
    ASSERT_TRUE(normalized);
    constexpr double kTol = 1e-9;  // rounding, through covariances of condition 1e4
    EXPECT_NEAR(*normalized, innovation.dot(inverse(S) * innovation) / 6, kTol);
    EXPECT_THAT(filter.pose(), IsNearPose(bend.start * SE3::exp(K * innovation), kTol));
    EXPECT_THAT(filter.poseCovariance(), IsNear(P - K * P, kTol));
    EXPECT_EQ(filter.velocityWorld_mps(), Eigen::Vector3d::Zero());  // one pose says nothing about it
  }
}

TEST(ObjectFilter, IsConsistentWithTheNoiseOfItsMeasurements) {
  const Bend bend;
  double nees = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    test::Noise noise(seed);
    ObjectFilter::Params params = plain();
    params.acceleration = {.along_mps2 = 1e-3,
                           .sideways_mps2 = 1e-3,
                           .vertical_mps2 = 1e-3,
                           .yaw_radps2 = 1e-3,
                           .tilt_radps2 = 1e-3};  // the truth's twist is constant
    ObjectFilter filter(params, stampOf(0), bend.start * SE3::exp(noise.correlated(kMeasured)), kMeasured);
    for (int frame = 1; frame < 30; ++frame) {
      filter.predict(stampOf(frame));
      filter.correct(bend.at(frame) * SE3::exp(noise.correlated(kMeasured)), kMeasured);
    }
    nees += test::nees(Vector6d((bend.at(29).inverse() * filter.pose()).log()), filter.poseCovariance());
    ++count;
  }
  EXPECT_NEAR(nees / count, 6, 1.5 * test::meanChi2Spread(6, count));  // half as much again for what is not linear
}

TEST(ObjectFilter, AnOutlierIsWeightedDown) {
  const Bend bend;
  ObjectFilter::Params robust = plain();
  robust.innovation_scale = 3;
  ObjectFilter trusting = followed(bend, 40), wary = followed(bend, 40, robust);
  Vector6d offset = Vector6d::Zero();
  offset[1] = 5;
  const auto correct = [&](ObjectFilter& filter) {
    filter.predict(stampOf(40));
    return filter.correct(bend.at(40) * SE3::exp(offset), kMeasured);
  };
  const auto plainly = correct(trusting), robustly = correct(wary);
  ASSERT_TRUE(plainly && robustly);
  EXPECT_GT(*robustly, 3 * 3);             // the innovation is told as it was,
  EXPECT_NEAR(*robustly, *plainly, 1e-6);  // before any weight
  const auto moved_m = [&](const ObjectFilter& filter) {
    return (filter.pose().translation() - bend.at(40).translation()).norm();
  };
  EXPECT_LT(moved_m(wary), 0.5 * moved_m(trusting));
}

TEST(ObjectFilter, WhatIsUnusableChangesNothing) {
  const Bend bend;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Matrix6d undefined = kMeasured, negative = kMeasured;
  undefined(0, 0) = nan;
  negative.diagonal().setConstant(-100);
  ObjectFilter filter = followed(bend, 10);
  const ObjectFilter before = filter;
  EXPECT_FALSE(filter.correct(bend.at(9), undefined));
  EXPECT_FALSE(filter.correct(bend.at(9), negative));
  EXPECT_FALSE(filter.correct(SE3(Eigen::Matrix3d::Identity(), {nan, 0, 0}), kMeasured));
  EXPECT_EQ(filter.pose().translation(), before.pose().translation());
  EXPECT_EQ(filter.velocityWorld_mps(), before.velocityWorld_mps());
  EXPECT_EQ(filter.poseCovariance(), before.poseCovariance());
}

TEST(ObjectFilter, NeitherTheSameMomentNorAnEarlierOneIsPredicted) {
  const Bend bend;
  ObjectFilter filter = followed(bend, 10);
  const ObjectFilter before = filter;
  for (const int frame : {9, 3}) {
    filter.predict(stampOf(frame));
    EXPECT_EQ(filter.pose().translation(), before.pose().translation());
    EXPECT_EQ(filter.poseCovariance(), before.poseCovariance());
  }
}

TEST(ObjectFilter, ProcessNoiseFollowsTheInnovations) {
  const Bend bend;
  const auto positionVariance = [&](double sigma_m, bool adapt) {
    test::Noise noise(1);
    ObjectFilter::Params params = plain();
    params.adapt_process_noise = adapt;
    ObjectFilter filter(params, stampOf(0), bend.start, kMeasured);
    for (int frame = 1; frame < 60; ++frame) {
      filter.predict(stampOf(frame));
      filter.correct(bend.at(frame) * SE3::exp(noise.correlated(covarianceOf(sigma_m, 0.1 * sigma_m))), kMeasured);
    }
    filter.predict(stampOf(70));
    return filter.poseCovariance().topLeftCorner<3, 3>().trace();
  };
  EXPECT_GT(positionVariance(0.4, true), 2 * positionVariance(0.4, false));      // four times as noisy as they claim
  EXPECT_LT(positionVariance(0.01, true), 0.5 * positionVariance(0.01, false));  // a tenth
}

TEST(ObjectFilter, TheSpeedIsAsUnsureAsSetUntilPosesTellIt) {
  const Bend bend;
  EXPECT_DOUBLE_EQ(followed(bend, 1).speedSigma_mps(), plain().initial_speed_sigma_mps);
  EXPECT_DOUBLE_EQ(followed(bend, 1).yawRateSigma_radps(), plain().initial_turn_rate_sigma_radps);
  EXPECT_LT(followed(bend, 2).speedSigma_mps(), 2);  // two poses to 0.1 m, 0.1 s apart
  EXPECT_LT(followed(bend, 30).speedSigma_mps(), followed(bend, 10).speedSigma_mps() + 1e-12);
}

}  // namespace
}  // namespace motorcade
