#include "apps/evaluate/comparison/recovered_finals.hpp"

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNearPose;

RunFolder::ObjectRow rowOf(std::int64_t frame, std::int64_t track, const SE3& T_world_body) {
  RunFolder::ObjectRow row{.frame = {frame}, .object = {}};
  row.object.track = {track};
  row.object.T_world_body = T_world_body;
  row.object.velocity_world_mps = {0, 0, 10};
  return row;
}

SE3 at(double x_m, double z_m) { return SE3(Eigen::Matrix3d::Identity(), {x_m, 0, z_m}); }

TEST(RecoveredFinals, GoOnFromTheLastFinalPose) {
  RunFolder run{.first_frame = 10};
  run.online.camera = {at(0, 0), at(0, 1), at(0, 2), at(0, 3)};
  const Eigen::Matrix3d turn = SE3::exp((Vector6d() << 0, 0, 0, 0, 0.1, 0).finished()).rotation();
  run.final.camera = {at(0, 0), SE3(turn, {0.5, 0, 1})};
  for (std::int64_t frame = 10; frame < 15; ++frame) run.online.objects.push_back(rowOf(frame, 1, at(2, 20)));
  run.final.objects = {rowOf(10, 1, at(2.5, 20)), rowOf(11, 1, at(2.5, 20)), rowOf(12, 1, at(9, 9))};

  EXPECT_EQ(recoverFinals(run), 2u);
  ASSERT_EQ(run.final.camera.size(), 4u);
  EXPECT_THAT(run.final.camera[1].inverse() * run.final.camera[3], IsNearPose(at(0, 2), 1e-12));
  ASSERT_EQ(run.final.objects.size(), 4u) << "without the row of a frame that is not final, and one without a pose";
  EXPECT_THAT(run.final.camera[2].inverse() * run.final.objects[2].object.T_world_body, IsNearPose(at(2, 18), 1e-12));
  EXPECT_NEAR((run.final.objects[2].object.velocity_world_mps - turn * Eigen::Vector3d(0, 0, 10)).norm(), 0, 1e-12);
  EXPECT_EQ(run.final.objects[3].frame.value, 13);
}

TEST(RecoveredFinals, LeaveAWholeRunAlone) {
  RunFolder run;
  run.online.camera = run.final.camera = {at(0, 0), at(0, 1)};
  run.final.objects = {rowOf(1, 1, at(2, 20))};
  EXPECT_EQ(recoverFinals(run), 0u);
  EXPECT_EQ(run.final.objects.size(), 1u);
}

TEST(RecoveredFinals, WithoutAnyFinalAllAreOnline) {
  RunFolder run;
  run.online.camera = {at(0, 0), at(0, 1)};
  run.online.objects = {rowOf(1, 1, at(2, 20))};
  EXPECT_EQ(recoverFinals(run), 2u);
  EXPECT_EQ(run.final.camera.size(), 2u);
  EXPECT_EQ(run.final.objects.size(), 1u);
}

}  // namespace
}  // namespace motorcade
