#include "io/messages/camera_info_message.hpp"

#include <limits>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/files/errors.hpp"
#include "io/rig/rig_file.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using testing::HasSubstr;

constexpr double kInfoBaseline_m = 0.54;

CameraInfoMessage rectifiedInfo(bool right) {
  return {.width = 1242,
          .height = 375,
          .distortion_model = "plumb_bob",
          .D = {0, 0, 0, 0, 0},
          .K = {720, 0, 610, 0, 720, 173, 0, 0, 1},
          .R = {1, 0, 0, 0, 1, 0, 0, 0, 1},
          .P = {720, 0, 610, right ? -720 * kInfoBaseline_m : 0, 0, 720, 173, 0, 0, 0, 1, 0}};
}

CameraInfoPair rectifiedInfos() {
  return {rectifiedInfo(false), rectifiedInfo(true), "/left/camera_info", "/right/camera_info"};
}

/// Lenses that distort, and stand a bit askew.
CameraInfoPair rawInfos() {
  CameraInfoPair infos = rectifiedInfos();
  infos.left.D = {-0.3, 0.1, 0.001, -0.002, 0};
  infos.right.D = {-0.31, 0.11, 0.002, -0.001, 0};
  infos.left.K = {950, 0, 690, 0, 951, 240, 0, 0, 1};
  infos.right.K = {952, 0, 680, 0, 953, 235, 0, 0, 1};
  infos.left.R = {0.9998, 0.02, 0, -0.02, 0.9998, 0, 0, 0, 1};
  infos.right.R = {0.9998, 0, -0.02, 0, 1, 0, 0.02, 0, 0.9998};
  return infos;
}

template <class Numbers>
std::string yamlMatrix(const char* name, const Numbers& numbers) {
  std::string text = std::string(name) + ":\n  data: [";
  for (const double number : numbers) text += std::to_string(number) + ", ";
  text.resize(text.size() - 2);
  return text + "]\n";
}

std::string yamlOf(const CameraInfoMessage& info) {
  return "image_width: 1242\nimage_height: 375\ndistortion_model: " + info.distortion_model + "\n" +
         yamlMatrix("camera_matrix", info.K) + yamlMatrix("distortion_coefficients", info.D) +
         yamlMatrix("rectification_matrix", info.R) + yamlMatrix("projection_matrix", info.P);
}

std::string refusalOf(const CameraInfoPair& infos, bool rectified = false) {
  try {
    rigOf(infos, rectified);
  } catch (const InputError& error) {
    return error.what();
  }
  return "taken";
}

TEST(CameraInfoMessage, OfRectifiedCamerasNothingIsLeftToBeDone) {
  const Rig rig = rigOf(rectifiedInfos(), false);
  ASSERT_TRUE(rig.rectified);
  EXPECT_EQ(rig.rectified->fx_px, 720);
  EXPECT_EQ(rig.rectified->cy_px, 173);
  EXPECT_NEAR(rig.rectified->baseline_m, kInfoBaseline_m, 1e-12);
}

TEST(CameraInfoMessage, RawCamerasAreRectifiedAsByTheSameCalibrationInFiles) {
  const CameraInfoPair infos = rawInfos();
  const test::TemporaryFolder folder;
  const Rig rig = rigOf(infos, false);
  const Rig by_files =
      readRig({folder.write("left.yaml", yamlOf(infos.left)), folder.write("right.yaml", yamlOf(infos.right))});
  ASSERT_TRUE(rig.given && by_files.given && !rig.rectified);
  for (const auto& [a, b] :
       {std::pair{rig.given->left, by_files.given->left}, {rig.given->right, by_files.given->right}}) {
    EXPECT_EQ(a.coefficients, b.coefficients);
    EXPECT_EQ(a.fx_px, b.fx_px);
    EXPECT_EQ(a.cy_px, b.cy_px);
    EXPECT_EQ(a.size, b.size);
  }
  EXPECT_TRUE(rig.given->R_left.isApprox(by_files.given->R_left, 1e-12));
  EXPECT_TRUE(rig.given->R_right.isApprox(by_files.given->R_right, 1e-12));
  EXPECT_NEAR(rig.given->camera.baseline_m, by_files.given->camera.baseline_m, 1e-12);
}

TEST(CameraInfoMessage, ImagesRectifiedBeforeGoByTheProjectionAlone) {
  CameraInfoPair infos = rawInfos();
  EXPECT_TRUE(rigOf(infos, true).rectified);
  infos.right.P[2] += 12;
  const Rig moved = rigOf(infos, true);
  ASSERT_TRUE(moved.given);
  EXPECT_EQ(moved.given->right.cx_px, moved.given->left.cx_px + 12);
  EXPECT_EQ(moved.given->camera.cx_px, moved.given->left.cx_px);
}

TEST(CameraInfoMessage, WhatCannotBeUsedIsNamed) {
  CameraInfoPair infos = rectifiedInfos();
  std::swap(infos.left.P, infos.right.P);
  EXPECT_THAT(refusalOf(infos), HasSubstr("/right/camera_info: gives a baseline of -0.54"));
  infos.left.P = infos.right.P;
  EXPECT_THAT(refusalOf(infos), HasSubstr("no baseline"));
  infos = rectifiedInfos();
  infos.left.P = {};
  EXPECT_THAT(refusalOf(infos), HasSubstr("/left/camera_info: has no focal lengths in P"));
  infos = rectifiedInfos();
  infos.left.K = {};
  EXPECT_THAT(refusalOf(infos), HasSubstr("no focal lengths in K"));
  EXPECT_EQ(refusalOf(infos, true), "taken");
  infos = rectifiedInfos();
  infos.right.R[0] = 2;
  EXPECT_THAT(refusalOf(infos), HasSubstr("R holds no rotation"));
  infos.right.R[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusalOf(infos), HasSubstr("no finite number"));
  infos = rectifiedInfos();
  infos.right.reduced = true;
  EXPECT_THAT(refusalOf(infos), HasSubstr("binned"));
  infos = rectifiedInfos();
  infos.left.distortion_model = "woodscape";
  EXPECT_THAT(refusalOf(infos), HasSubstr("D belongs to the distortion model 'woodscape'"));
  infos = rectifiedInfos();
  infos.left.width = 0xFFFFFFFF;
  EXPECT_THAT(refusalOf(infos), HasSubstr("no size of an image"));
}

TEST(CameraInfoMessage, ItsSizeIsHeldAgainstThatOfTheImages) {
  const Rig rig = rigOf(rectifiedInfos(), false);
  EXPECT_EQ(rectificationOf(rig, {1242, 375}).camera.width_px, 1242);
  EXPECT_THROW(rectificationOf(rig, {1241, 376}), InputError);
}

TEST(ImageTopics, TheCameraInfoLiesBesideTheImages) {
  EXPECT_EQ(cameraInfoTopicOf("/stereo/left/image_raw"), "/stereo/left/camera_info");
  EXPECT_EQ(cameraInfoTopicOf("/stereo/left/image_raw/compressed"), "/stereo/left/camera_info");
  EXPECT_EQ(cameraInfoTopicOf("left"), "camera_info");
  EXPECT_EQ(cameraInfoTopicOf("/left"), "/camera_info");
}

TEST(ImageTopics, TheNameTellsWhetherImagesAreRectified) {
  EXPECT_TRUE(isRectifiedTopic("/left/image_rect"));
  EXPECT_TRUE(isRectifiedTopic("/left/image_rect_color/compressed"));
  EXPECT_TRUE(isRectifiedTopic("image_rect"));
  EXPECT_FALSE(isRectifiedTopic("/left/image_raw"));
  EXPECT_FALSE(isRectifiedTopic("/image_rect/image_raw"));
}

}  // namespace
}  // namespace motorcade
