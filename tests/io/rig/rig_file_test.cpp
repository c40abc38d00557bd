#include "io/rig/rig_file.hpp"

#include <Eigen/LU>
#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/rig/rig_search.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::string_view kKalibr = R"(cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00002]
  distortion_model: radtan
  intrinsics: [458.6, 457.3, 367.2, 248.4]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [0.999997, -0.002317, -0.000343, -0.110074]
  - [0.002312, 0.999898, -0.014090, 0.000399]
  - [0.000376, 0.014089, 0.999901, -0.000853]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [0.01, 0.02, 0.03, 0.04]
  distortion_model: equidistant
  intrinsics: [457.6, 456.1, 380.0, 255.2]
  resolution: [752, 480]
)";

std::string rosFile(const std::string& fourth_of_P) {
  return "image_width: 640\nimage_height: 480\ncamera_name: narrow_stereo\n"
         "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [430.15, 0, 306.61, 0, 430.53, 227.23, 0, 0, 1]\n"
         "distortion_model: plumb_bob\n"
         "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.337, 0.111, -0.0007, 0.0004, 0.01]\n"
         "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
         "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [400, 0, 310, " +
         fourth_of_P + ", 0, 401, 230, 0, 0, 0, 1, 0]\n";
}

constexpr std::string_view kOpenCvIntrinsics = R"(%YAML:1.0
---
M1: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 535.4, 0., 342.4, 0., 535.5, 234.5, 0., 0., 1. ]
D1: !!opencv-matrix
   rows: 1
   cols: 14
   dt: d
   data: [ -0.28, 0.05, 0.001, -0.0001, 0.14, 0., 0., 0., 0., 0., 0., 0., 0., 0. ]
M2: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 537.1, 0., 327.6, 0., 536.7, 250.3, 0., 0., 1. ]
D2: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.29, 0.1, -0.0004, 0.0002, -0.03 ]
)";

constexpr std::string_view kOpenCvExtrinsics = R"(%YAML:1.0
---
R: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]
T: !!opencv-matrix
   rows: 3
   cols: 1
   dt: d
   data: [ -0.12, 0.001, 0.002 ]
)";

class RigFile : public testing::Test {
 protected:
  Rig read(const std::vector<std::string>& names) {
    std::vector<std::filesystem::path> files;
    for (const std::string& name : names) files.push_back(folder_ / name);
    return readRig(files);
  }
  std::string errorOf(const std::string& content) {
    folder_.write("bad.yaml", content);
    return messageOf<InputError>([&] { read({"bad.yaml"}); });
  }
  static std::string replaced(std::string_view text, const std::string& what, const std::string& by) {
    std::string result(text);
    result.replace(result.find(what), what.size(), by);
    return result;
  }
  test::TemporaryFolder folder_;
};

TEST_F(RigFile, KalibrsChainHasBothCamerasAndTheWayFromTheFirstToTheSecond) {
  folder_.write("camchain-rig.yaml", kKalibr);
  const Rig rig = readRig(usualRigFiles(folder_.path()));
  EXPECT_EQ(rig.left.distortion, Distortion::kRadialTangential);
  EXPECT_EQ(rig.left.coefficients[1], 0.07);
  EXPECT_EQ(rig.left.cy_px, 248.4);
  EXPECT_EQ(rig.right.distortion, Distortion::kEquidistant);
  EXPECT_EQ(rig.right.coefficients[3], 0.04);
  EXPECT_EQ(rig.right.size, (ImageSize{752, 480}));
  EXPECT_DOUBLE_EQ(rig.T_right_left.translation().x(), -0.110074);
  EXPECT_NEAR(rig.T_right_left.rotation()(1, 2), -0.01409, 1e-5);
  EXPECT_NEAR(rig.T_right_left.rotation().determinant(), 1, 1e-12);
  EXPECT_FALSE(rig.given);
}

TEST_F(RigFile, RosPairIsRectifiedAsItSays) {
  folder_.write("left.yaml", rosFile("0"));
  folder_.write("right.yaml", rosFile("-48"));
  const Rig rig = readRig(usualRigFiles(folder_.path()));
  ASSERT_TRUE(rig.given);
  EXPECT_DOUBLE_EQ(rig.given->camera.baseline_m, 0.12);
  EXPECT_EQ(rig.given->camera.fy_px, 401);
  EXPECT_EQ(rig.given->camera.cx_px, 310);
  EXPECT_EQ(rig.given->left.coefficients[4], 0.01);
  EXPECT_EQ(rig.left.size, (ImageSize{640, 480}));
  EXPECT_THAT(messageOf<InputError>([&] {
                read({"right.yaml", "left.yaml"});
              }),
              AllOf(HasSubstr("left.yaml"), HasSubstr("baseline"), HasSubstr("left file first")));
  EXPECT_THAT(messageOf<InputError>([&] { read({"left.yaml"}); }), HasSubstr("left.yaml,right.yaml"));
}

TEST_F(RigFile, OpenCvsFilesAreReadInEitherOrderAndAsOne) {
  folder_.write("intrinsics.yml", kOpenCvIntrinsics);
  folder_.write("extrinsics.yml", kOpenCvExtrinsics);
  folder_.write("one.yml", std::string(kOpenCvIntrinsics) + std::string(kOpenCvExtrinsics.substr(14)));
  for (const std::vector<std::string>& names : {std::vector<std::string>{"intrinsics.yml", "extrinsics.yml"},
                                                {"extrinsics.yml", "intrinsics.yml"},
                                                {"one.yml"}}) {
    const Rig rig = read(names);
    EXPECT_EQ(rig.left.coefficients[4], 0.14);
    EXPECT_EQ(rig.right.fx_px, 537.1);
    EXPECT_EQ(rig.T_right_left.translation().x(), -0.12);
  }
  EXPECT_EQ(usualRigFiles(folder_.path()).size(), 2U);
}

TEST_F(RigFile, WhatIsWrongIsNamedWithFileKeyAndLine) {
  EXPECT_THAT(errorOf(replaced(kKalibr, "pinhole", "omni")), AllOf(HasSubstr("bad.yaml"), HasSubstr("omni")));
  EXPECT_THAT(errorOf(replaced(kKalibr, "radtan", "fov")),
              AllOf(HasSubstr("cam0.distortion_coeffs"), HasSubstr("fov")));
  EXPECT_THAT(errorOf(replaced(kKalibr, "T_cn_cnm1", "T_other")), HasSubstr("cam1.T_cn_cnm1 is missing"));
  EXPECT_THAT(errorOf(replaced(kKalibr, "248.4]", "248.4, 1, 2]")),
              AllOf(HasSubstr("line 5"), HasSubstr("intrinsics")));
  EXPECT_THAT(errorOf(replaced(kKalibr, "458.6", "fast")), AllOf(HasSubstr("line 5"), HasSubstr("numbers")));
  EXPECT_THAT(errorOf(replaced(kKalibr, "458.6", "-3")), HasSubstr("focal lengths"));
  EXPECT_THAT(errorOf(replaced(kKalibr, "458.6", ".nan")), HasSubstr("numbers"));
  EXPECT_THAT(errorOf(replaced(kKalibr, "0.999898", "0.5")), HasSubstr("no rotation"));
  EXPECT_THAT(errorOf("cam0: [1, 2\n"), AllOf(HasSubstr("no YAML"), HasSubstr("line")));
  EXPECT_THAT(errorOf("just words"), HasSubstr("holds no keys"));
  EXPECT_THAT(errorOf("a: 1\n"), AllOf(HasSubstr("camchain"), HasSubstr("left.yaml,right.yaml")));
  EXPECT_THAT(messageOf<InputError>([&] { read({"missing.yaml"}); }), HasSubstr("missing.yaml"));
}

TEST_F(RigFile, TranslationInMillimetersIsRefused) {
  folder_.write("intrinsics.yml", kOpenCvIntrinsics);
  folder_.write("extrinsics.yml", replaced(kOpenCvExtrinsics, "-0.12", "-120"));
  EXPECT_THAT(messageOf<InputError>([&] { read({"intrinsics.yml", "extrinsics.yml"}); }), HasSubstr("in meters"));
}

}  // namespace
}  // namespace motorcade
