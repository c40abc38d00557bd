#include <cmath>
#include <iostream>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "backend/joint/joint_backend.hpp"
#include "tests/backend/point_drive.hpp"

namespace motorcade {
namespace {

using test::kPointRig;
using test::kStreet;
using test::PointDrive;

/// Mean normalized errors of the camera over ten frames and since the start, as seen with an exact calibration.
struct CameraNees {
  double motion = 0, pose = 0;
};

double neesOf(const SE3& truth, const SE3& estimate, const Matrix6d& covariance) {
  const Vector6d error = (truth.inverse() * estimate).log();
  return error.dot(covariance.llt().solve(error));
}

CameraNees cameraNees(const PointDrive::Options& options) {
  const WindowParams exact{.calibration = {0, 0, 0, 0, 0}};
  CameraNees sum;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    PointDrive drive(seed, options);
    JointBackend backend(JointParams{}, kPointRig, exact);
    const auto finals = test::runDrive(backend, drive).finals;
    for (std::size_t k = 19; k < finals.size(); k += 10, ++count) {
      const int now = static_cast<int>(k), then = now - kCameraCovarianceFrames;
      const SE3 truth_then = drive.truth().camera(then), truth_now = drive.truth().camera(now);
      const SE3 &T_world_then = finals[then].T_world_cam, &T_world_now = finals[now].T_world_cam;
      const CameraCovariances& covariances = finals[now].camera_covariances;
      sum.motion +=
          neesOf(truth_then.inverse() * truth_now, T_world_then.inverse() * T_world_now, covariances.motion.value());
      sum.pose += neesOf(drive.truth().camera(0).inverse() * truth_now, T_world_now, covariances.pose.value());
    }
  }
  EXPECT_GE(count, 16);
  std::cout << "mean normalized errors of " << count << ": over ten frames " << sum.motion / count
            << ", since the start " << sum.pose / count << "\n";
  return {sum.motion / count, sum.pose / count};
}

/// Six where the covariances are right; less where the noise that they allow for (an error that all disparities of a
/// landmark share) is not there. Errors since the start of one drive are nearly the same in all of its frames.
TEST(JointEstimates, CovariancesOfTheCameraAreOfTheSizeOfItsErrors) {
  const CameraNees nees = cameraNees(kStreet);
  EXPECT_GT(nees.motion, 1.5);
  EXPECT_LT(nees.motion, 9);
  EXPECT_GT(nees.pose, 1);
  EXPECT_LT(nees.pose, 12);
}

/// Errors that points in one cell of the image share, as those of a rectification, do not average out. Without the
/// design effect of cells it would be 7.9.
TEST(JointEstimates, CovariancesGrowByWhatErrorsHaveInCommon) {
  PointDrive::Options common = kStreet;
  common.field_sigma_px = 0.3;
  const double nees = cameraNees(common).motion;
  EXPECT_GT(nees, 1.5);
  EXPECT_LT(nees, 7);
}

/// Tests a vehicle in a bend, from the frame on in which its twist is known.
TEST(JointEstimates, YawRatesAreThoseOfTheBendWithinTheirSigmas) {
  PointDrive::Options options = kStreet;
  constexpr double kYawRate_radps = 0.2;
  options.drive.vehicles = {{{-2, 1, 25}, 0, 8, kYawRate_radps, 0, 1000}};
  PointDrive drive(1, options);
  JointBackend backend(JointParams{}, kPointRig);
  const auto run = test::runDrive(backend, drive);
  double squares = 0;
  int count = 0;
  for (std::size_t k = 10; k + 10 < run.finals.size(); k += 5) {
    const ObjectEstimate& object = run.online[k].objects.at(0);
    EXPECT_GT(object.yaw_rate_sigma_radps, 0);
    EXPECT_LT(object.yaw_rate_sigma_radps, 0.2);
    squares += std::pow((object.yaw_rate_radps - kYawRate_radps) / object.yaw_rate_sigma_radps, 2);
    EXPECT_NEAR(run.finals[k].objects.at(0).yaw_rate_radps, kYawRate_radps, 0.05);
    ++count;
  }
  std::cout << "mean normalized error " << squares / count << " of " << count << "\n";
  EXPECT_GE(count, 5);
  EXPECT_LT(squares / count, 4);  // one where the sigmas are right
}

/// A car that brakes in a bend, and with it turns ever more slowly.
PointDrive::Options brakingInABend() {
  PointDrive::Options options = kStreet;
  options.drive.frames = 34;
  options.drive.vehicles = {{{-2, 1, 20}, 0, 12, 0.3, 0, 1000, -2}};
  return options;
}

/// Mean squared errors of accelerations in units of their variances.
struct AccelerationNees {
  double along = 0, yaw = 0;
  int count = 0;

  void add(const ObjectAcceleration& told) {
    constexpr double kBraking_mps2 = -2, kYaw_radps2 = -2 * 0.3 / 12;
    ++count;
    along += (std::pow((told.along_mps2 - kBraking_mps2) / told.along_sigma_mps2, 2) - along) / count;
    yaw += (std::pow((told.yaw_radps2 - kYaw_radps2) / told.yaw_sigma_radps2, 2) - yaw) / count;
    EXPECT_LT(told.along_sigma_mps2, 1.5);
    EXPECT_LT(told.yaw_sigma_radps2, 0.4);
  }
};

TEST(JointEstimates, AccelerationsAreThoseOfACarThatBrakesInABend) {
  AccelerationNees of_finals, of_online;
  double mean_mps2 = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    PointDrive drive(seed, brakingInABend());
    JointBackend backend(JointParams{}, kPointRig);
    const auto run = test::runDrive(backend, drive);
    for (std::size_t k = 12; k < 28; k += 5) {
      ASSERT_TRUE(run.finals[k].objects.at(0).acceleration && run.online[k].objects.at(0).acceleration) << k;
      of_finals.add(*run.finals[k].objects[0].acceleration);
      of_online.add(*run.online[k].objects[0].acceleration);
      mean_mps2 += run.finals[k].objects[0].acceleration->along_mps2 / 16;
    }
  }
  std::cout << "mean normalized errors " << of_finals.along << " and " << of_finals.yaw << ", online "
            << of_online.along << " and " << of_online.yaw << ", of " << of_finals.count << "\n";
  EXPECT_NEAR(mean_mps2, -2, 0.3);  // of 16 with standard deviations of 0.5 each, four of which are independent
  EXPECT_LT(of_finals.along, 1.5);  // at most one where the sigmas are right: the walk does not walk
  EXPECT_LT(of_finals.yaw, 1.5);
  EXPECT_LT(of_online.along, 2.5);  // it brakes by twice the usual, and is drawn towards zero
  EXPECT_LT(of_online.yaw, 1.5);
}

TEST(JointEstimates, AccelerationsAreKnownFromTheSecondFrameOnAndBetterInThePast) {
  PointDrive drive(1, brakingInABend());
  JointBackend backend(JointParams{}, kPointRig);
  const auto run = test::runDrive(backend, drive);
  EXPECT_FALSE(run.online[0].objects.at(0).acceleration);
  EXPECT_TRUE(run.finals[0].objects.at(0).acceleration) << "what came later tells it";
  ASSERT_TRUE(run.online[1].objects.at(0).acceleration);
  const auto sigma_mps2 = [](const FrameEstimate& frame) { return frame.objects.at(0).acceleration->along_sigma_mps2; };
  EXPECT_GT(sigma_mps2(run.online[1]), sigma_mps2(run.online[15]));
  EXPECT_GT(sigma_mps2(run.online[15]), 1.2 * sigma_mps2(run.finals[15])) << "frames on one side alone";
}

TEST(JointEstimates, AccelerationsAreLessSureWhereThePointsAre) {
  const auto sigma_mps2 = [](double sigma_px) {
    PointDrive::Options options = brakingInABend();
    options.sigma_px = sigma_px;
    PointDrive drive(1, options);
    JointBackend backend(JointParams{}, kPointRig);
    return test::runDrive(backend, drive).finals[15].objects.at(0).acceleration->along_sigma_mps2;
  };
  EXPECT_GT(sigma_mps2(1.0), 1.3 * sigma_mps2(0.1));
}

/// Noise learned from the image holds for a vehicle that enters it.
TEST(JointEstimates, ANewObjectHasTheNoiseOfTheImage) {
  constexpr int kEnters = 40, kLook = kEnters + 5;
  const auto sigmaOf = [](double claimed) {
    PointDrive::Options options = kStreet;
    options.claimed = claimed;
    options.drive.vehicles = {{{2, 1, 45}, 0, 9, 0, kEnters, 1000}};
    PointDrive drive(1, options);
    JointBackend backend(JointParams{}, kPointRig);
    const auto online = test::runDrive(backend, drive).online;
    return online[kLook].objects.at(0).speed_sigma_mps;
  };
  const double honest_mps = sigmaOf(1), timid_mps = sigmaOf(3);
  std::cout << honest_mps << " m/s, with three times the noise claimed " << timid_mps << " m/s\n";
  EXPECT_LT(timid_mps, 1.15 * honest_mps);
}

}  // namespace
}  // namespace motorcade
