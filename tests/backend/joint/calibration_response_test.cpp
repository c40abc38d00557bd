#include "backend/joint/calibration_response.hpp"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "backend/joint/joint_graph.hpp"
#include "tests/backend/point_drive.hpp"

namespace motorcade {
namespace {

using test::kPointRig;
using test::PointDrive;

constexpr FrameId kNow{20}, kBefore{kNow.value - kCameraCovarianceFrames};

/// A street of points at rest, seen without noise but weighed as if with a quarter of a pixel, and an exact odometry.
/// The points are few: the response knows all of them, as the estimate does.
PointDrive::Options exactStreet() {
  PointDrive::Options options{.sigma_px = 0.0025, .claimed = 100, .static_points = 80, .drive = {}};
  options.drive.frames = static_cast<int>(kNow.value) + 1;
  options.drive.vehicles.clear();
  options.drive.odometry_sigma_m = options.drive.odometry_sigma_rad = 1e-6;
  return options;
}

using Change = std::function<void(FrameMeasurements&)>;

/// The window after the drive's frames, each changed.
std::unique_ptr<JointGraph> afterDrive(const Change& change = [](auto&) {}) {
  PointDrive drive(1, exactStreet());
  auto graph = std::make_unique<JointGraph>(JointParams{}, WindowParams{}, kPointRig);
  for (int frame = 0; frame <= kNow.value; ++frame) {
    FrameMeasurements measurements = *drive.measure(frame);
    for (PointMeasurement& m : measurements.at_rest) m.point.value *= 3;  // one in three is taken
    change(measurements);
    graph->add(measurements);
  }
  return graph;
}

/// Part of the standard deviations: larger errors of the lens make residuals so large that they count less.
constexpr double kPart = 0.1;

/// Change of the observations in a rig that has a part of the error `k`.
Change observedWith(int k) {
  return [k](FrameMeasurements& measurements) {
    for (PointMeasurement& m : measurements.at_rest) {
      const auto shifts = observationShifts(kPointRig, CalibrationSigmas{}, m.uvd_px.cast<double>());
      m.uvd_px -= (kPart * shifts.col(k)).cast<float>();
    }
  };
}

SE3 motionOf(const JointGraph& graph) { return graph.cameraPose(kBefore).inverse() * graph.cameraPose(kNow); }

TEST(CalibrationResponse, MotionsShiftAsTheJointEstimateDoes) {
  const auto exact = afterDrive();
  const auto shifts = exact->calibration().ofMotion(kBefore, kNow, exact->cameraPose(kNow));
  // The estimate knows older frames, too, and its landmarks' weights change with their residuals.
  constexpr double kTolerance = 0.32, kSmall_m = 2.5e-4, kSmall_rad = 4e-6;
  for (int k = 0; k < kCalibrationErrors; ++k) {
    const Vector6d error = (motionOf(*afterDrive(observedWith(k))).inverse() * motionOf(*exact)).log();
    const Vector6d expected = kPart * shifts.col(k);
    EXPECT_LT((error - expected).head<3>().norm(), kTolerance * error.head<3>().norm() + kSmall_m) << "error " << k;
    EXPECT_LT((error - expected).tail<3>().norm(), kTolerance * error.tail<3>().norm() + kSmall_rad) << "error " << k;
  }
}

TEST(CalibrationResponse, AMotionAcrossFramesWithoutPointsShiftsAsOneWithThem) {
  const auto seen = afterDrive(), blind = afterDrive([](FrameMeasurements&m) {
                                    if (m.head.frame.value > 12 && m.head.frame.value < 15) m.at_rest.clear();
                                  });
  const auto scale = [](const JointGraph& graph, std::int64_t before, std::int64_t now) {
    return graph.calibration().ofMotion({before}, {now}, graph.cameraPose({now})).row(2).norm();
  };
  EXPECT_GT(scale(*blind, 12, 15), 0.5 * scale(*seen, 12, 15));
  EXPECT_LT(scale(*blind, 12, 15), 2 * scale(*seen, 12, 15));
}

}  // namespace
}  // namespace motorcade
