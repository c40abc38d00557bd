#include "backend/window/window_backend.hpp"

#include <gtest/gtest.h>

#include "backend/joint/joint_backend.hpp"
#include "backend/pose_graph/pose_graph_backend.hpp"
#include "tests/backend/point_drive.hpp"

namespace motorcade {
namespace {

using test::kPointRig;
using test::kStreet;
using test::PointDrive;
using test::SimulatedDrive;

/// Frames before the confirmation are older than the lag with which final covariances are taken.
TEST(WindowBackend, RowsThatALateConfirmationBringsHaveCovariances) {
  SimulatedDrive drive(1, {.frames = 40, .confirmed_after = 20});
  PoseGraphSmoother smoother({});
  int rows = 0;
  for (const FrameEstimate& frame : test::runDrive(smoother, drive).finals) {
    for (const ObjectEstimate& object : frame.objects) {
      EXPECT_TRUE(object.covariance.has_value()) << "frame " << frame.head.frame.value;
      EXPECT_LT(object.speed_sigma_mps, 5) << "frame " << frame.head.frame.value;
      ++rows;
    }
  }
  EXPECT_GT(rows, 80);
}

/// Both final and online, of camera and objects.
TEST(WindowBackend, CovariancesHoldTheErrorsOfTheCalibration) {
  const auto resultWith = [](const CalibrationSigmas& sigmas) {
    PointDrive drive(1, kStreet);
    JointBackend backend({}, kPointRig, {.calibration = sigmas});
    return test::runDrive(backend, drive);
  };
  const auto exact = resultWith({0, 0, 0, 0, 0}), considered = resultWith({});
  for (const auto kind : {&test::DriveResult::online, &test::DriveResult::finals}) {
    const FrameEstimate &less = (exact.*kind).at(40), &more = (considered.*kind).at(40);
    EXPECT_EQ(less.T_world_cam.translation(), more.T_world_cam.translation());
    EXPECT_GT((*more.camera_covariances.motion)(2, 2), 4 * (*less.camera_covariances.motion)(2, 2));
    ASSERT_FALSE(less.objects.empty());
    for (std::size_t i = 0; i < less.objects.size(); ++i) {
      EXPECT_GT((*more.objects[i].covariance)(0, 0), (*less.objects[i].covariance)(0, 0));
      EXPECT_GT(more.objects[i].speed_sigma_mps, less.objects[i].speed_sigma_mps);
    }
  }
}

}  // namespace
}  // namespace motorcade
