#include "backend/motion/body_view.hpp"

#include <gtest/gtest.h>

#include "tests/backend/point_drive.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::IsNearPose;
using test::kPointRig;
using test::PointDrive;

bool any(PointId) { return true; }

/// Two frames of a drive with one vehicle.
struct TwoFrames {
  explicit TwoFrames(std::uint64_t seed, double sigma_px, double odometry = 1.0) {
    PointDrive::Options options{.sigma_px = sigma_px, .drive = {}};
    options.drive.vehicles.resize(1);
    options.drive.odometry_sigma_m *= odometry;
    options.drive.odometry_sigma_rad *= odometry;
    PointDrive drive(seed, options);
    for (int frame = 0; frame < 2; ++frame) {
      measured.push_back(drive.measure(frame));
      path.add(*measured.back());
    }
    truth = drive.truth().object(0, 0).inverse() * drive.truth().object(0, 1);
  }
  BodyView view(std::size_t frame) const {
    const ObjectObservation& seen = measured[frame]->objects.at(0);
    return {seen.frame, seen.measured, 0, seen.T_cam_body};
  }
  CameraPath path;
  std::vector<FrameMeasurementsPtr> measured;
  SE3 truth;
};

TEST(MotionBetween, IsExactWithoutNoise) {
  const TwoFrames frames(1, 1e-6, 1e-6);
  const auto motion = motionBetween(kPointRig, frames.view(0), frames.view(1), frames.path, any);
  ASSERT_TRUE(motion);
  EXPECT_EQ(motion->since, FrameId{0});
  EXPECT_THAT(motion->T_before_now, IsNearPose(frames.truth, 1e-4));  // measurements are floats of a thousand pixels
}

TEST(MotionBetween, ItsCovarianceHasBothViewsAndTheOdometry) {
  constexpr int kSeeds = 200;
  double nees = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const TwoFrames frames(seed, 0.25);
    const auto motion = motionBetween(kPointRig, frames.view(0), frames.view(1), frames.path, any);
    ASSERT_TRUE(motion);
    const Vector6d error = (frames.truth.inverse() * motion->T_before_now).log();
    nees += test::nees(error, motion->covariance) / kSeeds;
  }
  EXPECT_GT(nees, 2.5);  // robust weights make the covariance larger than the errors
  EXPECT_LT(nees, 6.5);
}

TEST(MotionBetween, TakesOnlyThePointsAskedFor) {
  const TwoFrames frames(2, 0.25, 1e-3);
  const auto half = [](PointId point) { return point.value % 2 == 0; };
  const auto all = motionBetween(kPointRig, frames.view(0), frames.view(1), frames.path, any),
             even = motionBetween(kPointRig, frames.view(0), frames.view(1), frames.path, half);
  ASSERT_TRUE(all && even);
  EXPECT_GT(even->covariance.trace(), 1.3 * all->covariance.trace());
  EXPECT_FALSE(motionBetween(kPointRig, frames.view(0), frames.view(1), frames.path,
                             [](PointId point) { return point.value < 2; }));
}

TEST(MotionBetween, IsEmptyWhereTheCameraPathDoesNotReach) {
  const TwoFrames frames(3, 0.25);
  EXPECT_FALSE(motionBetween(kPointRig, frames.view(0), frames.view(1), CameraPath{}, any));
}

TEST(Triangulate, AddsTheDisparityOffset) {
  const Eigen::Vector3d p_cam(2, 1, 20), uvd_px = *kPointRig.project(p_cam);
  const PointMeasurement point{
      {1}, Eigen::Vector3d(uvd_px - Eigen::Vector3d(0, 0, 1.5)).cast<float>(), Eigen::Vector3f::Constant(0.25F)};
  const BodyView view{.frame = {0}, .points = {&point, 1}, .disparity_offset_px = 1.5, .T_cam_body = {}};
  const auto triangulated = triangulate(kPointRig, view, point);
  ASSERT_TRUE(triangulated);
  EXPECT_THAT(triangulated->p_body, IsNear(p_cam, 1e-4));
  const BodyView without{.frame = {0}, .points = {&point, 1}, .disparity_offset_px = -30, .T_cam_body = {}};
  EXPECT_FALSE(triangulate(kPointRig, without, point));
}

TEST(CameraPath, AddsUpPosesAndCovariances) {
  CameraPath path;
  FrameMeasurements m;
  m.odometry.covariance = 0.01 * Matrix6d::Identity();
  for (int frame = 0; frame < 4; ++frame) {
    m.head.frame = {frame};
    m.odometry.T_previous_now = SE3(Eigen::Matrix3d::Identity(), {0, 0, frame > 0 ? 1.0 : 0.0});
    path.add(m);
  }
  EXPECT_THAT(path.find(FrameId{3})->T_world_cam.translation(), IsNear(Eigen::Vector3d(0, 0, 3), 1e-12));
  const auto covariance = path.covarianceSince(FrameId{1}, FrameId{3});
  ASSERT_TRUE(covariance);
  EXPECT_NEAR((*covariance)(2, 2), 0.02, 1e-12);
  EXPECT_NEAR((*covariance)(0, 0), 0.02 + 0.01, 1e-12);  // a turn in frame 2 moves frame 3 by 1 m per rad
  EXPECT_FALSE(path.covarianceSince(FrameId{-1}, FrameId{3}));
  EXPECT_THAT(path.find(FrameId{3})->pose_covariance, IsNear(*path.covarianceSince(FrameId{0}, FrameId{3}), 1e-12));
  EXPECT_EQ(path.find(FrameId{9}), nullptr);
}

}  // namespace
}  // namespace motorcade
