#include "frontend/motion/vehicle_calibration.hpp"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/frontend/motion/simulated_vehicle.hpp"

namespace motorcade {
namespace {

using test::SimulatedVehicle;

constexpr int kLearned_frames = 200;

UncertainMotion asSeen(const SE3& T_then_now) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(0.005), Eigen::Vector3d::Constant(0.0003);
  return {T_then_now, sigma.cwiseAbs2().asDiagonal()};
}

/// The simulated drive with its sensors, learned from for twenty seconds.
struct Learned {
  explicit Learned(const SimulatedVehicle& drive) {
    for (const auto& sample : drive.samples) samples.add(sample);
    for (int frame = 1; frame <= kLearned_frames; ++frame)
      calibration.learn(*samples.between(drive.stampOf(frame - 1), drive.stampOf(frame)),
                        asSeen(drive.motion(frame - 1, frame)));
  }
  UncertainMotion ahead(int frames) const {
    const auto pieces = samples.between(SimulatedVehicle::stampOf(kLearned_frames),
                                        SimulatedVehicle::stampOf(kLearned_frames + frames));
    return calibration.motionOver(*pieces);
  }
  VehicleSamples samples;
  VehicleCalibration calibration;
};

TEST(VehicleCalibration, ScaleAndBiasAreLearned) {
  const Learned learned(SimulatedVehicle(3, 220, {}));
  EXPECT_NEAR(learned.calibration.scale(), 1 / 1.02, 0.003);
  EXPECT_NEAR(learned.calibration.bias_radps(), 0.3 * 0.01745, 0.0007);
}

TEST(VehicleCalibration, WithoutNoiseTheMotionIsThatOfTheMountedCamera) {
  const SimulatedVehicle drive(
      5, 260, {.scale = 1, .bias_radps = 0, .delay_s = 0, .speed_noise_mps = 0, .yaw_rate_noise_radps = 0}, 0);
  const Learned learned(drive);
  const Vector6d error =
      (drive.motion(kLearned_frames, kLearned_frames + 30).inverse() * learned.ahead(30).T_then_now).log();
  EXPECT_LT(error.head<3>().norm(), 0.2);  // of 30 m, with bumps that turn the camera by a tenth of a degree
  EXPECT_LT(error.tail<3>().norm(), 0.01);
}

/// The errors of 200 drives lie within their covariance after so many frames without images.
void expectCovered(int frames, double most_error_share) {
  constexpr int kSeeds = 200;
  constexpr double kChi2_95 = 12.59;  // of six
  int covered = 0;
  double nees = 0, error_share = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const SimulatedVehicle drive(seed, kLearned_frames + frames + 5, {});
    const UncertainMotion told = Learned(drive).ahead(frames);
    const SE3 truth = drive.motion(kLearned_frames, kLearned_frames + frames);
    const Vector6d error = (told.T_then_now.inverse() * truth).log();
    const double chi2 = error.dot(told.covariance.ldlt().solve(error));
    covered += chi2 < kChi2_95;
    nees += chi2 / kSeeds;
    error_share += error.head<3>().norm() / truth.translation().norm() / kSeeds;
  }
  EXPECT_GE(covered, 0.95 * kSeeds);
  EXPECT_GT(nees, 0.8) << "far too wide";
  EXPECT_LT(error_share, most_error_share);
}

TEST(VehicleCalibration, ThreeSecondsWithoutImagesAreWithinTheirCovariance) { expectCovered(30, 0.012); }
TEST(VehicleCalibration, TenSecondsWithoutImagesAreWithinTheirCovariance) { expectCovered(100, 0.02); }

TEST(VehicleCalibration, WhatWheelsCannotDoIsSurprising) {
  const SimulatedVehicle drive(7, 220, {});
  const Learned learned(drive);
  const auto pieces = *learned.samples.between(SimulatedVehicle::stampOf(200), SimulatedVehicle::stampOf(201));
  const auto usual = learned.calibration.compare(pieces, asSeen(drive.motion(200, 201)));
  EXPECT_LT(usual.speed_sigmas, 2);
  EXPECT_LT(usual.yaw_rate_sigmas, 2);
  const auto standing = learned.calibration.compare(pieces, asSeen(SE3{}));
  EXPECT_GT(standing.speed_sigmas, 8);
  Vector6d turned = Vector6d::Zero();
  turned[4] = 0.02;
  const auto turning = learned.calibration.compare(pieces, asSeen(drive.motion(200, 201) * SE3::exp(turned)));
  EXPECT_GT(turning.yaw_rate_sigmas, 5);
}

}  // namespace
}  // namespace motorcade
