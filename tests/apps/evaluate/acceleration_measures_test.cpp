#include "apps/evaluate/measures/acceleration_measures.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/apps/evaluate/compared_frame_by_hand.hpp"

namespace motorcade {
namespace {

constexpr double kFrame_s = 0.1, kBraking_mps2 = -3, kYaw_radps2 = 0.2;
constexpr int kMeasuredFrames = 30;

std::vector<Timestamp> stampsOf(int frames) {
  std::vector<Timestamp> stamps;
  for (int i = 0; i < frames; ++i) stamps.push_back({static_cast<std::int64_t>(1e9 * kFrame_s * i)});
  return stamps;
}

/// A car that brakes steadily from 15 m/s and turns to the left ever faster, followed by a track that tells this.
std::vector<ComparedFrame> brakingCar() {
  std::vector<ComparedFrame> frames(kMeasuredFrames);
  const TrueObject label = test::labelByHand(7, 20);
  SE3 T_world_object = label.truth.T_cam_object;
  constexpr int kSteps = 1000;  // of a frame: the path is integrated
  for (int i = 0; i < kMeasuredFrames; ++i) {
    frames[i].frame = {i};
    frames[i].objects = {label};
    frames[i].objects[0].truth.T_world_object = T_world_object;
    frames[i].rows = {test::rowByHand(4, 0, 20)};
    frames[i].rows[0].row.object.acceleration = {
        .along_mps2 = kBraking_mps2, .along_sigma_mps2 = 0.1, .yaw_radps2 = kYaw_radps2, .yaw_sigma_radps2 = 0.01};
    for (int step = 0; step < kSteps; ++step) {
      const double t_s = kFrame_s * (i + (step + 0.5) / kSteps);
      Vector6d twist;  // y points down
      twist << 15 + kBraking_mps2 * t_s, 0, 0, 0, -kYaw_radps2 * t_s, 0;
      const Vector6d motion = kFrame_s / kSteps * twist;
      T_world_object = T_world_object * SE3::exp(motion);
    }
  }
  return frames;
}

/// Errors of taking chords for arcs, which are longer by a part in ten thousand here.
constexpr double kChords_mps2 = 5e-3, kChords_radps2 = 1e-4;

TEST(AccelerationErrors, AreNoneWhereWhatIsToldIsTrue) {
  const AccelerationErrors errors = accelerationErrors(brakingCar(), stampsOf(kMeasuredFrames));
  EXPECT_EQ(errors.rows, 18) << "from the tenth row on, up to the third before the last";
  EXPECT_EQ(errors.along_mps2.errors.count, 18U);
  EXPECT_LT(errors.along_mps2.errors.max, kChords_mps2);
  EXPECT_LT(errors.yaw_radps2.errors.max, kChords_radps2);
  EXPECT_EQ(errors.along_mps2.coverage, 1);
  EXPECT_EQ(errors.yaw_radps2.coverage, 1);
}

TEST(AccelerationErrors, AreHeldAgainstTheirStandardDeviations) {
  auto frames = brakingCar();
  for (int i = 0; i < kMeasuredFrames; ++i) {
    ObjectAcceleration& told = *frames[i].rows[0].row.object.acceleration;
    told.along_mps2 += i % 2 == 0 ? 0.15 : -0.25;  // 1.5 and 2.5 standard deviations
    told.yaw_radps2 += 0.03;
  }
  const AccelerationErrors errors = accelerationErrors(frames, stampsOf(kMeasuredFrames));
  EXPECT_NEAR(errors.along_mps2.errors.rmse, std::sqrt((0.15 * 0.15 + 0.25 * 0.25) / 2), kChords_mps2);
  EXPECT_EQ(errors.along_mps2.coverage, 0.5);
  EXPECT_NEAR(errors.yaw_radps2.errors.mean, 0.03, kChords_radps2);
  EXPECT_EQ(errors.yaw_radps2.coverage, 0);
}

TEST(AccelerationErrors, RowsThatTellNoneAreCountedAlone) {
  auto frames = brakingCar();
  for (int i = 0; i < 12; ++i) frames[i].rows[0].row.object.acceleration.reset();
  const AccelerationErrors errors = accelerationErrors(frames, stampsOf(kMeasuredFrames));
  EXPECT_EQ(errors.rows, 18);
  EXPECT_EQ(errors.along_mps2.errors.count, 15U);
  EXPECT_EQ(errors.along_mps2.coverage, 1);
}

TEST(AccelerationErrors, AreNotToldAroundFramesWithoutTheLabel) {
  auto frames = brakingCar();
  frames[20].objects.clear();
  frames[20].rows.clear();
  const AccelerationErrors errors = accelerationErrors(frames, stampsOf(kMeasuredFrames));
  EXPECT_EQ(errors.rows, 18 - 5) << "frames 17, 19, 21 and 23 need it, too, as a neighbor of an end of their span";
}

}  // namespace
}  // namespace motorcade
