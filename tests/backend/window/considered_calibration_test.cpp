#include "backend/window/considered_calibration.hpp"

#include <gtest/gtest.h>

#include "tests/backend/point_drive.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::kPointRig;
using PoseShifts = ConsideredCalibration::PoseShifts;

constexpr double kDt_s = 0.1;
const SE3 kStep = SE3::exp((Vector6d() << 0.02, -0.01, 0.9, 0.002, 0.02, -0.001).finished());

/// Different for each error and component, as large as a real one.
PoseShifts someShifts() {
  PoseShifts shifts;
  for (int k = 0; k < kCalibrationErrors; ++k)
    shifts.col(k) << 0.001 * k, -0.0005, 0.003 - 0.0004 * k, 1e-4, 2e-5 * k, -1e-4;
  return shifts;
}

SE3 poseIn(std::int64_t frame) { return frame == 0 ? SE3{} : (poseIn(frame - 1) * kStep).normalized(); }

/// Frames 1 to `last`, each with the same step.
ConsideredCalibration afterSteps(std::int64_t last) {
  ConsideredCalibration calibration(kPointRig, {});
  for (FrameId now{1}; now.value <= last; ++now.value)
    calibration.set(
        now, {.seconds = kDt_s, .T_before_now = kStep, .T_world_now = poseIn(now.value), .shifts = someShifts()});
  return calibration;
}

TEST(ConsideredCalibration, ShiftsOfStepsAddUpToThatOfTheirProduct) {
  const ConsideredCalibration calibration = afterSteps(3);
  for (int k = 0; k < kCalibrationErrors; ++k) {
    const SE3 shifted = kStep * SE3::exp(someShifts().col(k));
    const Vector6d expected = ((kStep * kStep).inverse() * shifted * shifted).log();
    EXPECT_THAT(Vector6d(calibration.ofMotion({1}, {3}, poseIn(3)).col(k)), IsNear(expected, 1e-5)) << "error " << k;
  }
}

TEST(ConsideredCalibration, TheWholePathIsKnownWhenItsStepsAreForgotten) {
  ConsideredCalibration calibration = afterSteps(3);
  const PoseShifts whole = calibration.ofMotion({0}, {3}, poseIn(3));
  constexpr double kSame = 1e-12;
  EXPECT_THAT(calibration.ofPose({3}, poseIn(3)), IsNear(whole, kSame));
  calibration.forget({2});
  EXPECT_THAT(calibration.ofPose({3}, poseIn(3)), IsNear(whole, kSame));
  EXPECT_THAT(calibration.ofMotion({2}, {3}, poseIn(3)), IsNear(someShifts(), kSame));
}

/// The errors of a step are computed anew when more is known.
TEST(ConsideredCalibration, ANewStepChangesWhatComesAfterIt) {
  ConsideredCalibration calibration = afterSteps(3);
  calibration.set({2}, {.seconds = kDt_s, .T_before_now = kStep, .T_world_now = poseIn(2)});
  constexpr double kSame = 1e-12;
  EXPECT_THAT(calibration.ofMotion({1}, {3}, poseIn(3)), IsNear(someShifts(), kSame)) << "the last step alone";
  EXPECT_THAT(calibration.ofMotion({0}, {1}, poseIn(1)), IsNear(someShifts(), kSame));
}

TEST(ConsideredCalibration, AnExactOneShiftsNothing) {
  const ConsideredCalibration exact;
  EXPECT_EQ(exact.ofMotion({0}, {2}, poseIn(2)).norm(), 0);
  EXPECT_EQ(exact.ofPoint({1, 1, 20}).norm(), 0);
  EXPECT_EQ(exact.ofVelocity({2}, {1, 1, 20}, {0, 0, 8}).norm(), 0);
}

/// Shifts a body's place, from the rig's observations of it, and its speed, from its places in two frames.
TEST(ConsideredCalibration, PlacesAndVelocitiesShiftAsTheObservationsTheyAreMadeOf) {
  const ConsideredCalibration calibration = afterSteps(2);
  const Eigen::Vector3d p_now{-3, 1, 18}, velocity_mps{1.5, 0, 13};
  const Eigen::Vector3d p_before = kStep * p_now - kDt_s * (kStep.rotation() * velocity_mps);
  for (int k = 0; k < kCalibrationErrors; ++k) {
    const auto estimated = [&](const Eigen::Vector3d& p) {
      const Eigen::Vector3d uvd_px = *kPointRig.project(p);
      return kPointRig.triangulate(uvd_px - observationShifts(kPointRig, CalibrationSigmas{}, uvd_px).col(k));
    };
    const Eigen::Vector3d place_error = p_now - estimated(p_now);
    EXPECT_THAT(Eigen::Vector3d(calibration.ofPoint(p_now).col(k)),
                IsNear(place_error, 0.02 * place_error.norm() + 1e-9))
        << "error " << k;
    const SE3 step = kStep * SE3::exp(-someShifts().col(k));
    const Eigen::Vector3d estimated_mps =
        step.rotation().transpose() * (step * estimated(p_now) - estimated(p_before)) / kDt_s;
    const Eigen::Vector3d error_mps = velocity_mps - estimated_mps;
    EXPECT_THAT(Eigen::Vector3d(calibration.ofVelocity({2}, p_now, velocity_mps).col(k)),
                IsNear(error_mps, 0.1 * error_mps.norm() + 0.01))
        << "error " << k;
  }
}

}  // namespace
}  // namespace motorcade
