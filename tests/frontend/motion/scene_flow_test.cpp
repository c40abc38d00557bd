#include "frontend/motion/scene_flow.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;
using test::Noise;

constexpr double kDt_s = 0.1;
const Eigen::Vector3d kCameraStep_m(0, 0, 1.0);  // 10 m/s

/// Camera in a bend, and points seen from it.
struct DriveInBend {
  CameraTrail trail;
  std::vector<SE3> T_world_cam;

  explicit DriveInBend(int frames) {
    const SE3 step(expSO3({0, 0.01, 0}), kCameraStep_m);
    for (int k = 0; k < frames; ++k) {
      T_world_cam.push_back(k ? T_world_cam.back() * step : SE3{});
      trail.add({static_cast<std::int64_t>(k * kDt_s * 1e9)}, k ? step : SE3{});
    }
  }
  /// A point at `p_cam` in the last frame, with velocity and acceleration in that camera's axes.
  PointTrack follow(const Eigen::Vector3d& p_cam, const Eigen::Vector3d& velocity_mps, Noise& noise,
                    const Eigen::Vector3d& acceleration_mps2 = {0, 0, 0}) const {
    const SE3& T_world_now = T_world_cam.back();
    // the error of the camera's path that the estimator allows for belongs to the noise
    const double jitter = SceneFlowEstimator::Params{}.pose_jitter_px;
    const Eigen::Vector3d sigma = (test::kObservationSigma_px.array().square() + jitter * jitter).sqrt();
    PointTrack track;
    for (std::size_t k = 0; k < T_world_cam.size(); ++k) {
      const double dt_s = kDt_s * (static_cast<double>(k) + 1 - static_cast<double>(T_world_cam.size()));
      const Eigen::Vector3d p_then_now = p_cam + dt_s * velocity_mps + 0.5 * dt_s * dt_s * acceleration_mps2;
      const Eigen::Vector3d p_then = T_world_cam[k].inverse() * (T_world_now * p_then_now);
      const Eigen::Vector3d uvd = *kRig.project(p_then) + noise.gaussian(sigma);
      track.add({static_cast<std::int64_t>(k), uvd.cast<float>(), test::kObservationSigma_px.cast<float>()});
    }
    return track;
  }
};

/// Model for points of constant velocity: no allowance for acceleration, and a loss without its linear part, which
/// would take about one percent off the chi-square values of clean data.
SceneFlowEstimator exactModel() {
  SceneFlowEstimator::Params params;
  params.acceleration_mps2 = 0;
  params.huber_sigmas = 100;
  params.iterations = 6;  // to convergence: velocities of lead cars start far away, at rest
  return {params, kRig};
}

std::optional<SceneFlow> flowOf(const SceneFlowEstimator& estimator, const DriveInBend& drive,
                                const PointTrack& track) {
  const auto fits = estimator.fit(track, drive.trail);
  return fits.at_rest ? fits.moving : std::nullopt;
}

/// Mean normalized error of velocity and of (position, velocity) over seeds.
struct MeanNees {
  double velocity = 0, state = 0;
};
MeanNees meanNees(int frames, const Eigen::Vector3d& velocity_mps, int seeds) {
  const SceneFlowEstimator estimator = exactModel();
  const DriveInBend drive(frames);
  MeanNees nees;
  for (int seed = 0; seed < seeds; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    const Eigen::Vector3d p = noise.inBox({-4, -1, 10}, {4, 1, 18});
    const auto flow = flowOf(estimator, drive, drive.follow(p, velocity_mps, noise));
    EXPECT_TRUE(flow);
    if (!flow) continue;
    Vector6d error;
    error << flow->p_cam - p, flow->velocity_mps - velocity_mps;
    nees.state += test::nees(error, flow->covariance) / seeds;
    nees.velocity += test::nees<3>(error.tail<3>(), flow->covariance.bottomRightCorner<3, 3>()) / seeds;
  }
  return nees;
}

class SceneFlowOverFrames : public testing::TestWithParam<int> {};

TEST_P(SceneFlowOverFrames, CovarianceIsThatOfTheErrors) {
  constexpr int kSeeds = 2000;
  for (const Eigen::Vector3d& velocity :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(-3, 0, 3), Eigen::Vector3d(0.5, 0, 10)}) {
    const MeanNees nees = meanNees(GetParam(), velocity, kSeeds);
    EXPECT_NEAR(nees.velocity, 3, 1.5 * test::meanChi2Spread(3, kSeeds))
        << velocity.transpose();  // nine intervals are to hold at once
    EXPECT_NEAR(nees.state, 6, 1.5 * test::meanChi2Spread(6, kSeeds)) << velocity.transpose();
  }
}

TEST_P(SceneFlowOverFrames, PointsAtRestFitWithTheirDegreesOfFreedom) {
  constexpr int kSeeds = 2000;
  const SceneFlowEstimator estimator = exactModel();
  const DriveInBend drive(GetParam());
  double mean = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    const auto flow = flowOf(estimator, drive, drive.follow(noise.inBox({-4, -1, 8}, {4, 1, 40}), {0, 0, 0}, noise));
    ASSERT_TRUE(flow);
    mean += flow->static_chi2 / kSeeds;
  }
  const double dof = 3.0 * GetParam() - 3;
  EXPECT_NEAR(mean, dof, 1.25 * test::meanChi2Spread(dof, kSeeds));  // three intervals are to hold at once
}

TEST_P(SceneFlowOverFrames, AccelerationLeavesTheVelocityWithinItsSigma) {
  constexpr int kSeeds = 2000;
  const SceneFlowEstimator::Params params;
  const SceneFlowEstimator estimator(params, kRig);
  const DriveInBend drive(GetParam());
  double mean = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    const Eigen::Vector3d a = noise.gaussian(Eigen::Vector3d(Eigen::Vector3d::Constant(params.acceleration_mps2)));
    const Eigen::Vector3d velocity(0.5, 0, 8), p = noise.inBox({-4, -1, 10}, {4, 1, 18});
    const auto flow = flowOf(estimator, drive, drive.follow(p, velocity, noise, a));
    ASSERT_TRUE(flow);
    mean += test::nees<3>(flow->velocity_mps - velocity, flow->covariance.bottomRightCorner<3, 3>()) / kSeeds;
  }
  // The allowance counts each observation's deviation as noise of its own, though one acceleration bends them all: the
  // standard deviation is right within a factor of two.
  EXPECT_LT(mean, 4 * 3);
  EXPECT_GT(mean, 0.25 * 3);
}

INSTANTIATE_TEST_SUITE_P(Windows, SceneFlowOverFrames, testing::Values(3, 5, 8));

TEST(SceneFlow, MoversAtTheCamerasOwnSpeedAreRecognized) {
  const SceneFlowEstimator estimator({}, kRig);
  const DriveInBend drive(6);
  const Eigen::Vector3d velocity = kCameraStep_m / kDt_s;  // hardly moves in the image
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Noise noise(seed);
    const auto flow = flowOf(estimator, drive, drive.follow({-1, 0.5, 15}, velocity, noise));
    ASSERT_TRUE(flow);
    EXPECT_GT(flow->static_chi2 - flow->moving_chi2, 50);  // at rest it would be chi2(3): never above 30
    const double sigma = std::sqrt(flow->covariance(5, 5));
    EXPECT_NEAR(flow->velocity_mps.z(), velocity.z(), 4 * sigma);
    EXPECT_LT(sigma, 2);
  }
}

TEST(SceneFlow, ATrackThatJumpsHasNone) {
  const SceneFlowEstimator estimator({}, kRig);
  const DriveInBend drive(8);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Noise noise(seed);
    PointTrack track = drive.follow({2, 0.5, 15}, {0, 0, 0}, noise);
    EXPECT_TRUE(flowOf(estimator, drive, track));
    for (std::size_t k = 0; k < 8; k += 2) track.observations[k].uvd_px.x() += 12;  // to a neighbor and back
    EXPECT_FALSE(flowOf(estimator, drive, track));
  }
}

TEST(SceneFlow, TwoObservationsTellNothing) {
  const SceneFlowEstimator estimator({}, kRig);
  const DriveInBend drive(2);
  Noise noise(1);
  EXPECT_FALSE(flowOf(estimator, drive, drive.follow({2, 0.5, 15}, {0, 0, 0}, noise)));
}

TEST(SceneFlow, ObservationsOfForgottenFramesAreLeftOut) {
  const SceneFlowEstimator estimator({}, kRig);
  const DriveInBend drive(8);
  Noise noise(1);
  PointTrack track = drive.follow({2, 0.5, 15}, {0, 0, 0}, noise);
  track.observations[0].step = -5;
  const auto flow = flowOf(estimator, drive, track);
  ASSERT_TRUE(flow);
  EXPECT_EQ(flow->observations, 7);
}

}  // namespace
}  // namespace motorcade
