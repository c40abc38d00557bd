#include "backend/joint/landmark.hpp"

#include <cmath>
#include <span>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "backend/joint/bundle_factor.hpp"
#include "tests/backend/unpacked.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

constexpr double kSigma_px = 0.25;
constexpr int kViews = 10;

/// A body that comes nearer, with landmarks that are followed with noise of their own.
class BodyComingNearer {
 public:
  explicit BodyComingNearer(std::uint64_t seed) : noise_(seed) {
    for (int k = 0; k < kViews; ++k) T_cam_body_.emplace_back(expSO3({0, 0.01 * k, 0}), Eigen::Vector3d(1, 1, 20 - k));
  }

  const std::vector<SE3>& poses() const { return T_cam_body_; }
  const LandmarkViews& landmarks() const { return landmarks_; }

  /// Adds one more landmark; returns its views.
  std::span<const LandmarkView> add(double sigma_px) {
    const Eigen::Vector3d p_body(noise_.uniform(-1, 1), noise_.uniform(-1, 1), noise_.uniform(-2, 2));
    for (int k = 0; k < kViews; ++k) {
      const Eigen::Vector3d uvd_px =
          *kRig.project(T_cam_body_[k] * p_body) + noise_.gaussian(Eigen::Vector3d(sigma_px, sigma_px, sigma_px));
      landmarks_.views.push_back({k, uvd_px, Eigen::Vector3d::Constant(1 / kSigma_px)});
    }
    landmarks_.first_view.push_back(static_cast<int>(landmarks_.views.size()));
    return landmarks_.of(landmarks_.count() - 1);
  }
  /// Distance of the first pose from where the landmarks put it, the others being known [m].
  double error_m(const LandmarkNoise& noise) const {
    const auto eliminated = eliminateLandmarks(kRig, noise, landmarks_, FramePose::kCamBody, T_cam_body_, 0);
    const Eigen::MatrixXd system = test::unpacked(eliminated.system);
    const Matrix6d H = system.topLeftCorner<6, 6>().selfadjointView<Eigen::Lower>();
    const Vector6d g = system.row(system.rows() - 1).head<6>().transpose();
    return (H.inverse() * g).head<3>().norm();
  }

 private:
  test::Noise noise_;
  std::vector<SE3> T_cam_body_;
  LandmarkViews landmarks_;
};

LandmarkFit fitOf(const BodyComingNearer& body, const LandmarkNoise& noise) {
  return {kRig, noise, FramePose::kCamBody, body.poses(), 0};
}

double meanVariance(double sigma_px) {
  constexpr int kTimes = 200;
  BodyComingNearer body(1);
  LandmarkFit fit = fitOf(body, {});
  double sum = 0;
  for (int i = 0; i < kTimes; ++i) {
    EXPECT_TRUE(fit(body.add(sigma_px)));
    sum += fit.variance() / kTimes;
  }
  return sum;
}

/// Few landmarks are much noisier than all: the loss takes a part of what they add.
TEST(LandmarkFit, FindsTheLandmarksOwnVariance) {
  EXPECT_NEAR(meanVariance(kSigma_px), 1, 0.2);
  const double freedom = LandmarkNoise{}.variance_freedom, rest = 3.0 * kViews - 3;
  EXPECT_NEAR(meanVariance(0.2 * kSigma_px), (freedom + 0.04 * rest) / (freedom + rest), 0.05);
  EXPECT_GT(meanVariance(3 * kSigma_px), 2);
}

TEST(LandmarkFit, WithoutFreedomAllVariancesAreAsClaimed) {
  BodyComingNearer body(2);
  LandmarkFit fit = fitOf(body, {.variance_freedom = 0});
  ASSERT_TRUE(fit(body.add(4 * kSigma_px)));
  EXPECT_EQ(fit.variance(), 1);
  EXPECT_EQ(fit.informationShare(), 1);
}

TEST(LandmarkFit, TheSharedErrorGrowsWithTheLandmarksNoise) {
  BodyComingNearer body(3);
  LandmarkFit fit = fitOf(body, {.shared_disparity_sigma_px = 0.03, .shared_disparity_share = 0.7});
  ASSERT_TRUE(fit(body.add(kSigma_px)));
  EXPECT_NEAR(fit.sharedErrorSigma_px(), std::hypot(0.03, 0.7 * kSigma_px * std::sqrt(fit.variance())), 1e-12);
}

struct MeanErrors {
  double own_m = 0, alike_m = 0;
};

/// Mean errors of a pose that landmarks tell, whose standard deviations are those claimed times that factor.
MeanErrors meanErrors(std::span<const double> sigma_factors) {
  constexpr int kTimes = 100;
  MeanErrors errors;
  for (int time = 0; time < kTimes; ++time) {
    BodyComingNearer body(100 + time);
    for (const double factor : sigma_factors) body.add(factor * kSigma_px);
    errors.own_m += body.error_m({}) / kTimes;
    errors.alike_m += body.error_m({.variance_freedom = 0}) / kTimes;
  }
  return errors;
}

TEST(EliminatedLandmarks, TellMoreWhenEachHasItsOwnVariance) {
  const std::vector<double> unequal{0.2, 0.2, 0.3, 0.3, 0.5, 0.5, 1, 1, 1.5, 1.5}, equal(10, 1.0);
  const MeanErrors of_unequal = meanErrors(unequal), of_equal = meanErrors(equal);
  EXPECT_LT(of_unequal.own_m, 0.75 * of_unequal.alike_m);
  EXPECT_LT(of_equal.own_m, 1.05 * of_equal.alike_m);
}

}  // namespace
}  // namespace motorcade
