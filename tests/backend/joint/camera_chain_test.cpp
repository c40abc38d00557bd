/// Tests how the camera's poses are linked where nothing is seen.

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "backend/joint/joint_backend.hpp"
#include "core/unknown_motion.hpp"
#include "tests/backend/point_drive.hpp"

namespace motorcade {
namespace {

using test::kPointRig;
using test::PointDrive;

struct Frames {
  int begin, end;
  bool contains(int frame) const { return frame >= begin && frame < end; }
};

/// Measures a drive of which nothing is seen in the dark frames. The odometry of the first frame after them spans them
/// all, except for a start in the dark, whose first frame has nothing to refer to.
FrameMeasurementsPtr measureWithDark(PointDrive& drive, int frame, const Frames& dark) {
  FrameMeasurements m = *drive.measure(frame);
  if (dark.contains(frame)) {
    m.head.status = FrameStatus::kLost;
    m.head.cause = FrameCause::kNothingFound;
    m.odometry.T_previous_now = SE3{};
    m.odometry.covariance = unknownMotionCovariance(0.1);
    m.at_rest.clear();
    m.undecided.clear();
    m.objects.clear();
  }
  if (frame == dark.end && dark.begin == 0) m.odometry.T_previous_now = SE3{};
  if (frame == dark.end && dark.begin > 0)
    m.odometry.T_previous_now = drive.truth().camera(dark.begin - 1).inverse() * drive.truth().camera(frame);
  return std::make_shared<const FrameMeasurements>(std::move(m));
}

struct Path {
  std::vector<FrameEstimate> online, finals;
};

/// The same with the vehicle's own sensors, which tell each step; images tell nothing of the first frame after the
/// dark.
FrameMeasurementsPtr measureWithSensors(PointDrive& drive, int frame, const Frames& dark) {
  FrameMeasurements m = *measureWithDark(drive, frame, dark);
  if (frame == 0) return std::make_shared<const FrameMeasurements>(std::move(m));
  const SE3 T_before_now = drive.truth().camera(frame - 1).inverse() * drive.truth().camera(frame);
  m.odometry.told = {T_before_now * SE3::exp(Vector6d::Constant(1e-3)), 1e-4 * Matrix6d::Identity()};
  if (frame == dark.end) {
    m.head.status = FrameStatus::kLost;
    m.head.cause = FrameCause::kUnlinked;
    m.undecided.insert(m.undecided.end(), m.at_rest.begin(), m.at_rest.end());
    m.at_rest.clear();
  }
  return std::make_shared<const FrameMeasurements>(std::move(m));
}

using Measure = FrameMeasurementsPtr (*)(PointDrive&, int, const Frames&);

Path follow(std::uint64_t seed, const Frames& dark, Measure measure = measureWithDark) {
  PointDrive drive(seed, {.static_points = 150, .drive = {.frames = 40}});
  JointBackend backend(JointParams{}, kPointRig);
  Path path;
  for (int frame = 0; frame < drive.options().frames; ++frame) {
    const auto estimates = backend(measure(drive, frame, dark));
    EXPECT_TRUE(estimates->problems.empty());
    path.online.push_back(estimates->online);
    path.finals.insert(path.finals.end(), estimates->finals.begin(), estimates->finals.end());
  }
  for (FrameEstimate& estimate : backend.finish()) path.finals.push_back(std::move(estimate));
  return path;
}

/// Error of the motion from frame `from` to frame `to`.
double motionError_m(const Path& path, int from, int to) {
  const test::SimulatedDrive truth(1, {});
  const SE3 found = path.finals[from].T_world_cam.inverse() * path.finals[to].T_world_cam;
  return (found.translation() - (truth.camera(from).inverse() * truth.camera(to)).translation()).norm();
}

TEST(CameraChain, AStartInTheDarkIsNoMotionUntilOneIsMeasured) {
  constexpr int kSeenFirst = 5;
  const Path path = follow(1, {0, kSeenFirst});
  ASSERT_EQ(path.finals.size(), 40u);
  for (int frame = 0; frame <= kSeenFirst; ++frame)
    EXPECT_LT(path.online[frame].T_world_cam.translation().norm(), 1e-6) << frame;
  EXPECT_LT(path.finals[kSeenFirst].T_world_cam.translation().norm(), 1e-3);  // what follows stays where it was
  EXPECT_GT(path.finals[0].T_world_cam.inverse().translation().norm(), 3);    // four meters, in truth
  EXPECT_LT(motionError_m(path, 0, kSeenFirst), 0.1);
}

TEST(CameraChain, BeforeAStartInTheDarkTheCameraMayHaveStood) {
  constexpr int kSeenFirst = 20;
  const Path path = follow(1, {0, kSeenFirst});
  EXPECT_LT(motionError_m(path, 11, kSeenFirst), 0.6);  // 7.2 m, ten times a motion that is known to 3 cm
  const SE3 before = path.finals[0].T_world_cam.inverse() * path.finals[9].T_world_cam;
  EXPECT_LT(before.translation().norm(), 0.1);
}

TEST(CameraChain, UnseenFramesLieOnASteadyMotion) {
  const Path path = follow(2, {20, 28});
  ASSERT_EQ(path.finals.size(), 40u);
  EXPECT_LT(motionError_m(path, 19, 28), 0.05);
  for (int frame = 20; frame < 28; ++frame) EXPECT_LT(motionError_m(path, 19, frame), 0.5) << frame;
}

TEST(CameraChain, ACameraThatWasPredictedToStopIsFoundToHaveGoneOn) {
  constexpr Frames kDark{16, 28};
  const Path path = follow(2, kDark, [](PointDrive& drive, int frame, const Frames& dark) {
    FrameMeasurements m = *measureWithDark(drive, frame, dark);
    const bool goes_on = frame < (dark.begin + dark.end) / 2;
    if (dark.contains(frame) && goes_on)
      m.odometry.T_previous_now = drive.truth().camera(frame - 1).inverse() * drive.truth().camera(frame);
    if (frame == dark.end)
      m.odometry.T_previous_now =
          drive.truth().camera((dark.begin + dark.end) / 2 - 1).inverse() * drive.truth().camera(frame);
    return std::make_shared<const FrameMeasurements>(std::move(m));
  });
  for (int frame = kDark.begin; frame < kDark.end; ++frame)
    EXPECT_LT(motionError_m(path, kDark.begin - 1, frame), 0.7) << frame;
}

TEST(CameraChain, TheVehiclesOwnMotionLinksWhatImagesDoNot) {
  const Path path = follow(2, {20, 28}, measureWithSensors);
  ASSERT_EQ(path.finals.size(), 40u);
  for (int frame = 20; frame <= 28; ++frame) EXPECT_LT(motionError_m(path, 19, frame), 0.05) << frame;
  const auto position_sigma_m = [](const FrameEstimate& estimate) {
    return std::sqrt(estimate.camera_covariances.pose->topLeftCorner<3, 3>().trace());
  };
  ASSERT_TRUE(path.online[28].camera_covariances.pose) << "no new part begins";
  EXPECT_GT(position_sigma_m(path.online[27]), 0.2);  // eight steps of 1 cm and 10 mrad each way, over 8 m
  EXPECT_LT(position_sigma_m(path.online[27]), 0.5);
}

TEST(CameraChain, AStartInTheDarkIsDrivenAsTheVehicleTells) {
  const Path path = follow(1, {0, 5}, measureWithSensors);
  EXPECT_LT(motionError_m(path, 0, 5), 0.05);
}

}  // namespace
}  // namespace motorcade
