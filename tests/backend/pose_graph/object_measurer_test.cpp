#include "backend/pose_graph/object_measurer.hpp"

#include <gtest/gtest.h>

#include "tests/backend/point_drive.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::kPointRig;
using test::PointDrive;

SE3 truePose(const PointDrive& drive, const ObjectObservation& seen) {
  const int frame = static_cast<int>(seen.frame.value);
  return drive.truth().camera(frame).inverse() * drive.truth().object(seen.track.value - 100, frame);
}

TEST(ObjectMeasurer, EncountersAndMotionsAreThoseOfThePoints) {
  PointDrive drive(1, {.sigma_px = 1e-4, .drive = {.odometry_sigma_m = 1e-6, .odometry_sigma_rad = 1e-7}});
  ObjectMeasurer measure(kPointRig);
  int motions = 0;
  for (int frame = 0; frame < 40; ++frame)
    for (const ObjectObservation& seen : measure(*drive.measure(frame)).objects) {
      EXPECT_THAT(seen.T_cam_body, test::IsNearPose(truePose(drive, seen), 5e-3)) << frame;  // pixels are floats
      if (!seen.motion) continue;
      ++motions;
      const std::size_t vehicle = seen.track.value - 100;
      const SE3 truth = drive.truth().object(vehicle, frame - 1).inverse() * drive.truth().object(vehicle, frame);
      EXPECT_THAT(seen.motion->T_before_now, test::IsNearPose(truth, 5e-3)) << frame;
    }
  EXPECT_GT(motions, 60);  // of 115 steps
}

TEST(ObjectMeasurer, TheFirstPoseIsAChoiceAndTheFurtherOnesMeasurements) {
  PointDrive drive(2, {});
  ObjectMeasurer measure(kPointRig);
  const auto first = measure(*drive.measure(0)), second = measure(*drive.measure(1));
  EXPECT_LT(first.objects.at(0).encounter_covariance.trace(), 1e-4);
  EXPECT_FALSE(first.objects.at(0).motion);
  EXPECT_GT(second.objects.at(0).encounter_covariance.trace(), 1e-4);
}

TEST(ObjectMeasurer, EachMeasurementOfAPointServesOneFactor) {
  // Moving one point's pixel in one frame changes the encounter of that frame or the motion, not both.
  for (const std::int64_t role : {0, 1, 2, 3}) {
    PointDrive drive(3, {}), again(3, {});
    ObjectMeasurer measure(kPointRig), measure_moved(kPointRig);
    bool encounter = false, motion_into = false, motion_out_of = false;
    for (int frame = 0; frame < 3; ++frame) {
      const FrameMeasurements plain = measure(*drive.measure(frame));
      FrameMeasurements moved = *again.measure(frame);
      for (PointMeasurement& point : moved.objects[0].measured)
        if (frame == 1 && point.point.value % 4 == role) point.uvd_px.x() += 0.2F;
      moved = measure_moved(moved);
      const auto &a = plain.objects[0], &b = moved.objects[0];
      const bool motion_differs =
          a.motion && b.motion && (a.motion->T_before_now.inverse() * b.motion->T_before_now).log().norm() > 2e-3;
      if (frame == 1) encounter = (a.T_cam_body.inverse() * b.T_cam_body).log().norm() > 1e-4;
      if (frame == 1) motion_into = motion_differs;
      if (frame == 2) motion_out_of = motion_differs;
    }
    EXPECT_EQ(encounter, role != 3) << role;
    EXPECT_EQ(motion_into || motion_out_of, role == 3) << role;
  }
}

TEST(ObjectMeasurer, WithoutPointsAnObservationStaysAsItIs) {
  test::SimulatedDrive drive(4, {});
  ObjectMeasurer measure(kPointRig);
  for (int frame = 0; frame < 3; ++frame) {
    const auto m = drive.measure(frame);
    const auto measured = measure(*m);
    for (std::size_t i = 0; i < m->objects.size(); ++i) {
      EXPECT_THAT(measured.objects[i].T_cam_body, test::IsNearPose(m->objects[i].T_cam_body, 1e-12));
      EXPECT_EQ(measured.objects[i].motion.has_value(), m->objects[i].motion.has_value());
    }
  }
}

}  // namespace
}  // namespace motorcade
