#include "tests/io/rig/rig_forms.hpp"

#include <string>
#include <utility>

/// Forms of calibration programs: Kalibr, EuRoC, ROS, OpenCV; and those that are known but not read.
namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string chainCamera(const std::string& name, const std::string& lens, const std::string& transforms) {
  return name + ":\n  camera_model: pinhole\n  distortion_model: radtan\n  resolution: [752, 480]\n" + lens +
         transforms;
}
const std::string kLeftLens =
    "  intrinsics: [458.6, 457.3, 367.2, 248.4]\n  distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00002]\n";
const std::string kRightLens =
    "  intrinsics: [457.6, 456.1, 380.0, 255.2]\n  distortion_coeffs: [-0.27, 0.06, 0.0003, 0.0001]\n";

std::string chain(const std::string& of_left, const std::string& of_right) {
  return chainCamera("cam0", kLeftLens, of_left) + chainCamera("cam1", kRightLens, of_right);
}
std::string transform(const std::string& key, std::string_view numbers) {
  return "  " + key + ": " + braced(numbers) + "\n";
}

TEST_F(RigForms, KalibrsChainTellsByWhatItHas) {
  for (const auto& [left, right] :
       {std::pair(std::string(), transform("T_cn_cnm1", kRightLeft)),
        std::pair(transform("T_imu_cam", kBodyLeft), transform("T_imu_cam", kBodyRight)),
        std::pair(transform("T_cam_imu", kLeftBody), transform("T_imu_cam", kBodyRight)),
        std::pair(transform("T_imu_cam", kBodyLeft),
                  transform("T_cn_cnm1", kRightLeft) + transform("T_imu_cam", kBodyRight))}) {
    const Rig rig = read(chain(left, right));
    expectTransform(rig);
    expectLenses(rig);
    EXPECT_EQ(rig.remark, "");
  }
  const Rig of_three = read(chain("", transform("T_cn_cnm1", kRightLeft)) + chainCamera("cam2", kLeftLens, ""));
  EXPECT_EQ(of_three.remark, "cam0 and cam1 of more cameras");
}

TEST_F(RigForms, KalibrsChainThatContradictsItselfIsRefused) {
  const std::string body = transform("T_imu_cam", kBodyLeft);
  EXPECT_THAT(errorOf(chain(body, transform("T_cn_cnm1", kRightLeft) + body)),
              AllOf(HasSubstr("cam1.T_cn_cnm1 disagrees"), HasSubstr("110.0"), HasSubstr("line 14")));
  EXPECT_THAT(errorOf(chain(body + transform("T_cam_imu", kBodyLeft), body)),
              HasSubstr("cam0.T_cam_imu is not the inverse of T_imu_cam"));
  EXPECT_THAT(errorOf(chain("", body)), AllOf(HasSubstr("cam1.T_cn_cnm1 is missing"), HasSubstr("of both cameras")));
  EXPECT_THAT(errorOf(chainCamera("cam0", kLeftLens, "")), HasSubstr("a chain of one camera"));
  std::string no_model = chain("", transform("T_cn_cnm1", kRightLeft));
  no_model.erase(no_model.find("  distortion_model: radtan\n"), 27);
  EXPECT_THAT(errorOf(no_model), AllOf(HasSubstr("cam0.distortion_coeffs"), HasSubstr("add distortion_model")));
  for (const char* model : {"omni", "ds", "eucm"}) {
    std::string other = chain("", transform("T_cn_cnm1", kRightLeft));
    other.replace(other.find("pinhole"), 7, model);
    EXPECT_THAT(errorOf(other), AllOf(HasSubstr(std::string("is ") + model), HasSubstr("pinhole-equi")));
  }
}

TEST_F(RigForms, InverseTransformIsCalledSo) {
  for (const std::string& content :
       {chain("", transform("T_cn_cnm1", kLeftRight)),
        std::string(
            "M1: [500, 0, 376, 0, 500, 240, 0, 0, 1]\nM2: [500, 0, 376, 0, 500, 240, 0, 0, 1]\nD1: [0, 0, 0, 0, 0]\n"
            "D2: [0, 0, 0, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [0.11, 0, 0]\n")}) {
    const Rig rig = read(content);
    EXPECT_THAT(
        messageOf<InputError>([&] {
          rectificationOf(rig, {752, 480});
        }),
        AllOf(HasSubstr("is the inverse of what is meant"), HasSubstr("T"), HasSubstr("cameras are exchanged")));
  }
  std::string by_columns(kRightLeft);
  by_columns.replace(by_columns.rfind("0, 0, 0, 1"), 10, "-0.11, 0, 0, 1");
  EXPECT_THAT(errorOf(chain("", transform("T_cn_cnm1", by_columns))), HasSubstr("column by column"));
}

std::string sensor(std::string_view T_BS, const std::string& lens) {
  std::string text = "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: " + braced(T_BS) +
                     "\nrate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\n" + lens +
                     "distortion_model: radial-tangential\n";
  for (std::size_t at = 0; (at = text.find("\n  intrinsics", at)) != std::string::npos;) text.erase(at + 1, 2);
  for (std::size_t at = 0; (at = text.find("\n  distortion", at)) != std::string::npos;) text.erase(at + 1, 2);
  return text;
}

TEST_F(RigForms, EurocsSensorFilesPlaceBothCameras) {
  const Rig rig = read(sensor(kBodyLeft, kLeftLens), sensor(kBodyRight, kRightLens), ".yaml");
  expectTransform(rig);
  expectLenses(rig);
  EXPECT_THAT(errorOf(sensor(kBodyLeft, kLeftLens)), HasSubstr("cam0/sensor.yaml,cam1/sensor.yaml"));
}

TEST_F(RigForms, RosCamerasMayStandInOneFile) {
  const auto camera = [](const std::string& fourth) {
    return "  K: [430, 0, 306, 0, 430, 227, 0, 0, 1]\n  D: [-0.33, 0.11, -0.0007, 0.0004, 0]\n"
           "  R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n  P: [400, 0, 310, " +
           fourth + ", 0, 401, 230, 0, 0, 0, 1, 0]\n";
  };
  const Rig rig = read("left:\n" + camera("0") + "right:\n" + camera("-48"));
  ASSERT_TRUE(rig.given);
  EXPECT_DOUBLE_EQ(rig.given->camera.baseline_m, 0.12);
  EXPECT_THAT(errorOf("camera_matrix: [430, 0, 306, 0, 430, 227, 0, 0, 1]\ndist_coeffs: [0, 0, 0, 0, 0]\n"),
              HasSubstr("of one camera, without projection_matrix"));
}

std::string openCv(const std::string& D1, const std::string& rest = "") {
  return "M1: [500, 0, 376, 0, 501, 240, 0, 0, 1]\nM2: [502, 0, 370, 0, 503, 241, 0, 0, 1]\nD1: " + D1 +
         "\nD2: [0, 0, 0, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-0.11, 0, 0]\n" + rest;
}

TEST_F(RigForms, FourCoefficientsWithoutAModelAreRefusedWhereTheyMayBeAFishEyes) {
  for (const char* fish_eye :
       {"[-0.00604, 0.04517, -0.04255, 0.00777]", "[0.0034, 0.0007, -0.002, 0.0002]", "[-0.25, 0.06, 0.05, 0]"})
    EXPECT_THAT(errorOf(openCv(fish_eye)), AllOf(HasSubstr("line 3"), HasSubstr("distortion_model: equidistant")));
  EXPECT_EQ(read(openCv("[-0.25, 0.06, 0.0005, -0.0003]")).left.distortion, Distortion::kRadialTangential);
  EXPECT_EQ(read(openCv("[0.0034, 0.0007, -0.002, 0.0002, 0]")).left.distortion, Distortion::kRadialTangential);
  EXPECT_EQ(read(openCv("[0, 0, 0, 0]")).left.distortion, Distortion::kNone);
  const Rig named = read(openCv("[-0.00604, 0.04517, -0.04255, 0.00777]", "distortion_model: equidistant\n"));
  EXPECT_EQ(named.left.distortion, Distortion::kEquidistant);
  EXPECT_EQ(named.left.coefficients[3], 0.00777);
}

TEST_F(RigForms, OpenCvsNumbersStandInXmlAndJsonToo) {
  const Rig xml = read(R"(<?xml version="1.0"?>
<opencv_storage>
<!-- by stereo_calib -->
<calibrationDate>"Mon 4 Nov"</calibrationDate>
<M1 type_id="opencv-matrix"><rows>3</rows><cols>3</cols><dt>d</dt><data>
    500. 0. 376. 0. 501. 240. 0. 0. 1.</data></M1>
<D1 type_id="opencv-matrix"><rows>1</rows><cols>5</cols><dt>d</dt><data>-0.28 0.05 1e-3 0 0.14</data></D1>
<M2 type_id="opencv-matrix"><rows>3</rows><cols>3</cols><dt>d</dt><data>502 0 370 0 503 241 0 0 1</data></M2>
<D2><_>0</_><_>0</_><_>0</_><_>0</_><_>0.2</_></D2>
<R type_id="opencv-matrix"><rows>3</rows><cols>3</cols><dt>d</dt><data>1 0 0 0 1 0 0 0 1</data></R>
<T type_id="opencv-matrix"><rows>3</rows><cols>1</cols><dt>d</dt><data>
  -1.1e-01 0. 0.</data></T>
</opencv_storage>)",
                       "stereo.xml");
  EXPECT_EQ(xml.left.cy_px, 240);
  EXPECT_EQ(xml.left.coefficients[4], 0.14);
  EXPECT_EQ(xml.right.coefficients[4], 0.2);
  EXPECT_EQ(xml.T_right_left.translation().x(), -0.11);
  const Rig json =
      read(R"({"cameraMatrix1": [[500, 0, 376], [0, 501, 240], [0, 0, 1]], "distCoeffs1": [[-0.28, 0.05, 0, 0, 0]],
	"cameraMatrix2": [[502, 0, 370], [0, 503, 241], [0, 0, 1]], "distCoeffs2": [[0, 0, 0, 0, 0]],
	"R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "T": [[-0.11], [0], [0]]})",
           "stereo.json");
  EXPECT_EQ(json.left.cy_px, 240);
  EXPECT_EQ(json.left.coefficients[1], 0.05);
  EXPECT_EQ(json.T_right_left.translation().x(), -0.11);
  EXPECT_THAT(errorOf("<opencv_storage>\n<M1>", "cut.xml"), AllOf(HasSubstr("line 2"), HasSubstr("is no XML")));
  std::string transposed = openCv("[0, 0, 0, 0, 0]");
  transposed.replace(transposed.find("500, 0, 376, 0, 501, 240, 0, 0, 1"), 33, "500, 0, 0, 0, 501, 0, 376, 240, 1");
  EXPECT_THAT(errorOf(transposed), HasSubstr("MATLAB"));
}

TEST_F(RigForms, ExtrinsicsAloneAreNotEnough) {
  EXPECT_THAT(errorOf("R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-0.1, 0, 0]\nP1: [1]\n"),
              AllOf(HasSubstr("not their lenses"), HasSubstr("intrinsics.yml,extrinsics.yml")));
}

TEST_F(RigForms, CalibrationOfAnotherSizeIsToldByItsMiddle) {
  const Rig rig = read(openCv("[0, 0, 0, 0, 0]"));
  EXPECT_NO_THROW(rectificationOf(rig, {752, 480}));
  EXPECT_NO_THROW(rectificationOf(rig, {752, 380}));  // of which a strip was cut off
  for (const ImageSize other : {ImageSize{376, 240}, ImageSize{1504, 960}})
    EXPECT_THAT(messageOf<InputError>([&] { rectificationOf(rig, other); }), HasSubstr("another image size"));
}

TEST_F(RigForms, WhatIsKnownButNotReadIsNamedWithWhatToDo) {
  for (const auto& [name, content, what, advice] :
       {std::array{"stereo.npz", "PK\x03\x04 arrays", "NumPy", "FileStorage"},
        std::array{"stereo.mat", "MATLAB 5.0 MAT-file, Platform: GLNXA64", "MATLAB", "transposed"},
        std::array{"results-cam.txt.yaml",
                   "Calibration results\n====\nCamera-system parameters:\ncam0 (/cam0/image_raw):\n", "Kalibr's report",
                   "camchain"},
        std::array{"SN123.conf", "[LEFT_CAM_HD]\nfx=701.8\n[STEREO]\nBaseline=119.9\n", "ZED", "--camera"},
        std::array{"eeprom.json", "{\"cameraData\": [[0, {\"intrinsicMatrix\": [[1]]}]]}", "DepthAI", "--camera"},
        std::array{"ost.ini",
                   "# oST version 5.0 parameters\n[image]\nwidth\n640\n[narrow]\ncamera matrix\n1 0\n"
                   "rectification\nprojection\n",
                   "ROS", "left.yaml,right.yaml"},
        std::array{"calibrated_sensor.json", "[{\"sensor_token\": \"a\", \"camera_intrinsic\": []}]", "nuScenes",
                   "pair"},
        std::array{"estimator_config.yaml", "relative_config_imucam: \"kalibr_imucam_chain.yaml\"\n", "OpenVINS",
                   "kalibr_imucam_chain.yaml"}})
    EXPECT_THAT(errorOf(content, name), AllOf(HasSubstr(name), HasSubstr(what), HasSubstr(advice)));
}

}  // namespace
}  // namespace motorcade::test
