#include "frontend/geometry/stereo_pose.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/decompositions.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::IsNearPose;
using test::kRig;
using test::Noise;

SE3 trueMotion() {
  Vector6d xi;
  xi << 0.05, -0.02, -1.1, 0.004, 0.02, -0.003;
  return SE3::exp(xi);  // T_now_previous of a car at 11 m/s and 10 Hz in a bend
}

/// Fits from the identity with default parameters.
std::optional<PoseFit> fit(const std::vector<PoseObservation>& observations, const PosePrior* prior = nullptr) {
  return fitPose(kRig, PoseObservations(observations), SE3{}, {}, prior);
}

std::vector<PoseObservation> observe(int count, double near_m, double far_m, Noise& noise) {
  std::vector<PoseObservation> observations;
  while (static_cast<int>(observations.size()) < count) {
    const Eigen::Vector3d p = test::streetPoint(noise, near_m, far_m);
    if (const auto o = test::lookTwice(p, trueMotion() * p, noise)) observations.push_back(*o);
  }
  return observations;
}

TEST(StereoPose, NoiseFreePointsGiveTheExactPose) {
  Noise noise(1);
  auto observations = observe(30, 6, 30, noise);
  for (auto& o : observations) o.uvd_px = *kRig.project(trueMotion() * o.p_ref);
  const auto found = fit(observations);
  ASSERT_TRUE(found);
  // Gauss-Newton's last step is below 1e-6, and the error is quadratic in it.
  EXPECT_THAT(found->T_cam_ref, IsNearPose(trueMotion(), 1e-8));
}

/// A point so far away that rounding leaves a matrix that is no covariance.
TEST(StereoPose, APointBeyondAllMeasureDoesNotSpoilTheOthers) {
  Noise noise(2);
  auto observations = observe(60, 6, 40, noise);
  const auto without = fit(observations);
  observations.push_back(observations.front());
  observations.back().covariance_ref = -100 * Eigen::Matrix3d::Identity();
  const auto with = fit(observations);
  ASSERT_TRUE(without && with);
  EXPECT_THAT(with->T_cam_ref, IsNearPose(without->T_cam_ref, 1e-9));
  EXPECT_GT(poseChi2(kRig, PoseObservations(observations), trueMotion()).back(), 1e9);
}

TEST(StereoPose, CovarianceIsThatOfTheErrors) {
  constexpr int kSeeds = 1000;
  double mean = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    const auto found = fit(observe(80, 6, 30, noise));
    ASSERT_TRUE(found);
    const Vector6d error = (trueMotion().inverse() * found->T_cam_ref).log();
    mean += test::nees(error, found->covariance) / kSeeds;
  }
  EXPECT_NEAR(mean, 6, test::meanChi2Spread(6, kSeeds));
}

TEST(StereoPose, ThirtyPercentOutliersDoNotMoveIt) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Noise noise(seed);
    auto observations = observe(100, 6, 30, noise);
    for (std::size_t i = 0; i < 30; ++i) observations[i].uvd_px += noise.inBox({-40, -15, -8}, {40, 15, 8});
    const auto found = fit(observations);
    ASSERT_TRUE(found);
    const Vector6d error = (trueMotion().inverse() * found->T_cam_ref).log();
    EXPECT_LT(test::nees(error, found->covariance), 30) << "seed " << seed;  // chi2(6) is below it but for 4 in 100,000
    const auto chi2 = poseChi2(kRig, PoseObservations(observations), found->T_cam_ref);
    ASSERT_EQ(chi2.size(), observations.size());
    int rejected = 0;
    for (std::size_t i = 0; i < 30; ++i) rejected += chi2[i] > 16;
    EXPECT_GT(rejected, 24);  // the rest fell close to the truth by chance
  }
}

TEST(StereoPose, APriorFillsWhatThePointsLeaveOpen) {
  Noise noise(3);
  const auto observations = observe(1, 10, 12, noise);
  EXPECT_FALSE(fit(observations));
  Vector6d off;
  off << 0.02, 0, 0.03, 0, 0.002, 0;
  const PosePrior prior{trueMotion() * SE3::exp(off), 1e4 * Matrix6d::Identity()};
  const auto found = fit(observations, &prior);
  ASSERT_TRUE(found);
  EXPECT_THAT(found->T_cam_ref, IsNearPose(trueMotion(), 0.05));  // the prior's own distance and a point's depth noise
  const Matrix6d gained = inverse(found->covariance) - 1e4 * Matrix6d::Identity();
  // A measurement never takes information from a prior, but for the prior's curvature: a thousandth of it.
  EXPECT_GT(SymmetricEigen(gained).values.minCoeff(), -10);
}

TEST(StereoPose, WithoutPointsThePriorComesBack) {
  const PosePrior prior{trueMotion(), 25 * Matrix6d::Identity()};
  const auto found = fit({}, &prior);
  ASSERT_TRUE(found);
  EXPECT_THAT(found->T_cam_ref, IsNearPose(prior.mean, 1e-6));  // the convergence limit
  EXPECT_THAT(found->covariance, IsNear(0.04 * Matrix6d::Identity(), 1e-8));
}

TEST(StereoPose, FarPointsDoNotStretchTheMotion) {
  constexpr int kSeeds = 200;
  double sum = 0, sum2 = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Noise noise(static_cast<std::uint64_t>(1000 + seed));
    auto observations = observe(30, 6, 25, noise);
    const auto far = observe(120, 40, 100, noise);  // disparities of 4 to 10 px: depths off by up to 8 m
    observations.insert(observations.end(), far.begin(), far.end());
    const auto found = fit(observations);
    ASSERT_TRUE(found);
    const double error = found->T_cam_ref.translation().z() - trueMotion().translation().z();
    sum += error;
    sum2 += error * error;
  }
  const double mean = sum / kSeeds, sigma_of_mean = std::sqrt((sum2 / kSeeds - mean * mean) / kSeeds);
  EXPECT_LT(std::abs(mean), 3 * sigma_of_mean);
}

TEST(StereoPose, Chi2IsThatOfEachObservationAlone) {
  Noise noise(4);
  const auto observations = observe(7, 6, 30, noise);  // one full block and one of three
  const SE3 T = trueMotion();
  const auto chi2 = poseChi2(kRig, PoseObservations(observations), T);
  ASSERT_EQ(chi2.size(), observations.size());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const auto& o = observations[i];
    const Eigen::Vector3d p = T * o.p_ref, r = o.uvd_px - *kRig.project(p);
    const Eigen::Matrix3d J = kRig.projectionJacobian(p) * T.rotation();
    Eigen::Matrix3d S = J * o.covariance_ref * J.transpose();
    S.diagonal() += o.sigma_px.cwiseAbs2();
    EXPECT_NEAR(chi2[i], r.dot(S.inverse() * r), 1e-9 * (1 + chi2[i]));
  }
}

TEST(StereoPose, AScoreIsTheWeightedSumOfTruncatedChi2) {
  Noise noise(7);
  const auto observations = observe(13, 6, 30, noise);
  std::vector<double> weights;
  for (std::size_t i = 0; i < observations.size(); ++i) weights.push_back(0.1 * static_cast<double>(i % 5));
  const auto chi2 = poseChi2(kRig, PoseObservations(observations), SE3{});
  double sum = 0;
  for (std::size_t i = 0; i < chi2.size(); ++i) sum += weights[i] * std::min(12.0, chi2[i]);
  const auto score = [&](double bound) {
    return poseScore(kRig, PoseObservations(observations), SE3{}, {weights, 12.0}, bound);
  };
  EXPECT_EQ(score(2 * sum), sum);
  EXPECT_GE(score(0.5 * sum), 0.5 * sum);
}

TEST(StereoPose, PointsBehindTheCameraHaveInfiniteChi2) {
  Noise noise(5);
  auto observations = observe(2, 6, 30, noise);
  observations[0].p_ref.z() = -3;
  const auto chi2 = poseChi2(kRig, PoseObservations(observations), trueMotion());
  ASSERT_EQ(chi2.size(), 2u);
  EXPECT_TRUE(std::isinf(chi2[0]));
  EXPECT_TRUE(std::isfinite(chi2[1]));
}

}  // namespace
}  // namespace motorcade
