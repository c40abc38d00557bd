#include "io/rig/rectification.hpp"

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/rig/remap.hpp"
#include "tests/io/rig/rigs_by_hand.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::equidistantCamera;
using test::kSize;
using test::messageOf;
using test::radialCamera;
using test::rigOf;
using testing::HasSubstr;

TEST(Rectification, PointsLieInTheSameRowOfBothImagesAndTheirDisparityTellsTheirDepth) {
  test::Noise noise(3);
  constexpr double kRounding = 1e-12;
  for (const LensCamera& camera : {radialCamera(), equidistantCamera()}) {
    const Rig rig = rigOf(camera);
    const Rectification pair = rectificationOf(rig, kSize);
    EXPECT_NEAR(pair.camera.baseline_m, rig.T_right_left.translation().norm(), kRounding);
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d p_left(noise.uniform(-2, 2), noise.uniform(-1, 1), noise.uniform(1, 9));
      const Eigen::Vector3d in_left = pair.R_left * p_left, in_right = pair.R_right * (rig.T_right_left * p_left);
      EXPECT_NEAR(in_left.y(), in_right.y(), kRounding);
      EXPECT_NEAR(in_left.z(), in_right.z(), kRounding);
      EXPECT_NEAR(in_left.x() - in_right.x(), pair.camera.baseline_m, kRounding);
    }
  }
}

TEST(Rectification, BothImagesFillTheFrameAndNoneIsEnlargedMoreThanThatAsksFor) {
  for (const LensCamera& camera : {radialCamera(), equidistantCamera()}) {
    const Rig rig = rigOf(camera);
    const auto shareOutside = [&](const Rectification& pair) {
      return std::max(Remap(rig.left, pair.R_left, pair.camera, kSize).shareOutside(),
                      Remap(rig.right, pair.R_right, pair.camera, kSize).shareOutside());
    };
    Rectification pair = rectificationOf(rig, kSize);
    EXPECT_EQ(shareOutside(pair), 0);
    pair.camera.fx_px *= 0.98;
    pair.camera.fy_px *= 0.98;
    EXPECT_GT(shareOutside(pair), 0);
    EXPECT_EQ(pair.camera.width_px, kSize.width);
    EXPECT_EQ(pair.camera.height_px, kSize.height);
  }
}

TEST(Rectification, VeryWideLensKeepsItsResolutionInTheMiddle) {
  LensCamera wide = equidistantCamera();
  wide.fx_px = wide.fy_px = 95;  // 190 degrees across the image's diagonal
  const Rectification pair = rectificationOf(rigOf(wide), kSize);
  EXPECT_NEAR(pair.camera.fx_px, kLeastZoom * 95, 0.2);
}

TEST(Rectification, WhatTheCalibrationGivesIsUsedAsItIs) {
  Rig rig = rigOf(radialCamera());
  rig.given = Rectification{.left = rig.left, .right = rig.right, .camera = {.fx_px = 200, .fy_px = 201}};
  const Rectification pair = rectificationOf(rig, kSize);
  EXPECT_EQ(pair.camera.fy_px, 201);
  EXPECT_EQ(pair.camera.height_px, kSize.height);
  EXPECT_EQ(pair.R_left, Eigen::Matrix3d::Identity());
}

TEST(Rectification, RigsThatCannotBeFollowedAreRefusedByName) {
  const auto errorOf = [](const Rig& rig) { return messageOf<InputError>([&] { rectificationOf(rig, kSize); }); };
  Rig rig = rigOf(radialCamera());
  rig.T_right_left = SE3(Eigen::Matrix3d::Identity(), {0.11, 0, 0});
  EXPECT_THAT(errorOf(rig), testing::AllOf(HasSubstr("by hand"), HasSubstr("exchange")));
  rig.T_right_left = SE3(Eigen::Matrix3d::Identity(), {0, -0.11, 0});
  EXPECT_THAT(errorOf(rig), HasSubstr("side by side"));
  rig.T_right_left = SE3();
  EXPECT_THAT(errorOf(rig), HasSubstr("same place"));
  rig.T_right_left = SE3(expSO3({0, 2, 0}), {0.11, 0, 0}).inverse();
  EXPECT_THAT(errorOf(rig), HasSubstr("nothing in common"));
  rig = rigOf(radialCamera());
  rig.right.size = {640, 480};
  EXPECT_THAT(errorOf(rig), testing::AllOf(HasSubstr("640x480"), HasSubstr("376x240")));
}

}  // namespace
}  // namespace motorcade
