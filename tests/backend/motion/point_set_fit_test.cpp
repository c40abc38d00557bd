#include "backend/motion/point_set_fit.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::IsNearPose;

const StereoCamera kCamera{720, 720, 620, 188, 0.54, 1242, 375};
const SE3 kT_cam_ref(expSO3({0.05, -0.3, 0.1}), {1, 1.2, 14});
constexpr double kSigma_px = 0.25, kSigmaRef_m = 0.03;

ExpectedPose near(const SE3& T_cam_ref) {
  Vector6d sigma;
  sigma << 2, 2, 2, 0.2, 0.2, 0.2;
  return {T_cam_ref, sigma};
}

/// A car's points as `noise` has them known and seen; without noise they are exact.
std::vector<SeenPoint> pointsOf(int count, std::uint64_t seed, bool exact) {
  test::Noise noise(seed);
  std::vector<SeenPoint> points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p = noise.inBox({-2, -0.9, 0}, {2, 0.9, 1.5});
    SeenPoint point{p, kSigmaRef_m * kSigmaRef_m * Eigen::Matrix3d::Identity(), *kCamera.project(kT_cam_ref * p),
                    Eigen::Vector3d::Constant(kSigma_px)};
    if (!exact) {
      point.p_ref += noise.gaussian(Eigen::Vector3d(Eigen::Vector3d::Constant(kSigmaRef_m)));
      point.uvd_px += noise.gaussian(point.sigma_px);
    }
    points.push_back(point);
  }
  return points;
}

TEST(PointSetFit, FindsThePoseOfExactPointsFromAMeterAway) {
  Vector6d away;
  away << 0.6, -0.5, 0.7, 0.05, -0.02, 0.08;
  const auto fit = fitPointSet(kCamera, pointsOf(20, 1, true), near(kT_cam_ref * SE3::exp(away)));
  ASSERT_TRUE(fit);
  constexpr double kPulled = 0.01;  // by the expectation, 1 m away with 2 m sigma, against 20 points
  EXPECT_THAT(fit->T_cam_ref, IsNearPose(kT_cam_ref, kPulled));
  const auto at_truth = fitPointSet(kCamera, pointsOf(20, 1, true), near(kT_cam_ref));
  ASSERT_TRUE(at_truth);
  EXPECT_THAT(at_truth->T_cam_ref, IsNearPose(kT_cam_ref, 1e-9));
}

TEST(PointSetFit, ItsCovarianceHasTheErrorsOfBothSides) {
  constexpr int kSeeds = 300;
  double nees = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const auto fit = fitPointSet(kCamera, pointsOf(25, seed, false), near(kT_cam_ref));
    ASSERT_TRUE(fit);
    nees += test::nees(Vector6d((kT_cam_ref.inverse() * fit->T_cam_ref).log()), fit->covariance) / kSeeds;
  }
  // Cauchy's weights count good points for less than they are (0.8 of the information at scale 1.5 and below), so that
  // the covariance is larger than the errors.
  EXPECT_GT(nees, 2.5);
  EXPECT_LT(nees, 6.5);
}

TEST(PointSetFit, OutliersHardlyMoveIt) {
  auto points = pointsOf(24, 3, true);
  for (std::size_t i = 0; i < points.size(); i += 6) points[i].uvd_px += Eigen::Vector3d(15, -8, 4);
  const auto fit = fitPointSet(kCamera, points, near(kT_cam_ref));
  ASSERT_TRUE(fit);
  EXPECT_THAT(fit->T_cam_ref, IsNearPose(kT_cam_ref, 0.03));
}

TEST(PointSetFit, LeavesOpenDirectionsToTheExpectation) {
  const auto fit = fitPointSet(kCamera, pointsOf(1, 4, true), near(kT_cam_ref));
  ASSERT_TRUE(fit);
  EXPECT_THAT(fit->T_cam_ref, IsNearPose(kT_cam_ref, 1e-6));
  const Vector6d sigma = fit->covariance.diagonal().cwiseSqrt();
  EXPECT_GT(sigma.tail<3>().maxCoeff(), 0.1);
}

TEST(PointSetFit, IsEmptyBehindTheCamera) {
  const SE3 behind(Eigen::Matrix3d::Identity(), {0, 0, -20});
  EXPECT_FALSE(fitPointSet(kCamera, pointsOf(10, 5, true), near(behind)));
}

}  // namespace
}  // namespace motorcade
