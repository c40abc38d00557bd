#include <string>

#include <gmock/gmock.h>

#include "io/errors.hpp"
#include "io/rig/rig_file.hpp"
#include "tests/io/temporary_folder.hpp"

/// The forms of makers, all of one rig: the right camera 0.11 m to the right, turned by 10 mrad about x.
namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

// p_right = R * p_left + t, and its inverse.
constexpr std::string_view kRightLeft =
    "1, 0, 0, -0.11, 0, 0.99995000041666528, -0.0099998333341666645, 0, 0, 0.0099998333341666645, "
    "0.99995000041666528, 0, 0, 0, 0, 1";
constexpr std::string_view kLeftRight =
    "1, 0, 0, 0.11, 0, 0.99995000041666528, 0.0099998333341666645, 0, 0, -0.0099998333341666645, "
    "0.99995000041666528, 0, 0, 0, 0, 1";
// A body whose x is the left camera's z, y its -x, z its -y; the left camera stands 1 m ahead and 0.2 m up.
constexpr std::string_view kBodyLeft = "0, 0, 1, 1, -1, 0, 0, 0, 0, -1, 0, 0.2, 0, 0, 0, 1";
constexpr std::string_view kBodyRight =
    "0, -0.0099998333341666645, 0.99995000041666528, 1, -1, 0, 0, -0.11, 0, -0.99995000041666528, "
    "-0.0099998333341666645, 0.2, 0, 0, 0, 1";
// The inverse of kBodyLeft.
constexpr std::string_view kLeftBody = "0, -1, 0, 0, 0, 0, -1, 0.2, 1, 0, 0, -1, 0, 0, 0, 1";

std::string braced(std::string_view numbers) { return "[" + std::string(numbers) + "]"; }
std::string matrix(std::string_view numbers, int rows = 4, int cols = 4) {
  return "!!opencv-matrix\n   rows: " + std::to_string(rows) + "\n   cols: " + std::to_string(cols) +
         "\n   dt: d\n   data: " + braced(numbers) + "\n";
}

class RigForms : public testing::Test {
 protected:
  Rig read(const std::string& content, const std::string& name = "file.yaml") {
    return readRig({folder_.write(name, content)});
  }
  Rig read(const std::string& left, const std::string& right, const std::string& extension) {
    return readRig({folder_.write("left" + extension, left), folder_.write("right" + extension, right)});
  }
  std::string errorOf(const std::string& content, const std::string& name = "file.yaml") {
    return messageOf<InputError>([&] { read(content, name); });
  }
  static void expectTransform(const Rig& rig) {
    EXPECT_NEAR(rig.T_right_left.translation().x(), -0.11, 1e-12);
    EXPECT_NEAR(rig.T_right_left.translation().tail<2>().norm(), 0, 1e-12);
    EXPECT_NEAR((logSO3(rig.T_right_left.rotation()) - Eigen::Vector3d(0.01, 0, 0)).norm(), 0, 1e-9);
    EXPECT_NEAR(rectificationOf(rig, {752, 480}).camera.baseline_m, 0.11, 1e-9);
  }
  /// About EuRoC's lenses.
  static void expectLenses(const Rig& rig) {
    EXPECT_EQ(rig.left.fx_px, 458.6);
    EXPECT_EQ(rig.left.cy_px, 248.4);
    EXPECT_EQ(rig.right.fy_px, 456.1);
    EXPECT_EQ(rig.right.cx_px, 380);
    EXPECT_EQ(rig.left.distortion, Distortion::kRadialTangential);
    EXPECT_EQ(rig.left.coefficients[0], -0.28);
    EXPECT_EQ(rig.right.coefficients[3], 0.0001);
  }
  test::TemporaryFolder folder_;
};

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
              AllOf(HasSubstr("cam1.T_cn_cnm1 disagrees"), HasSubstr("110.0"), HasSubstr("line 13")));
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

TEST_F(RigForms, ListsOfPlacedCamerasAreOkvisAndMaplabs) {
  const auto okvis = [](std::string_view T_SC, const std::string& lens) {
    return "     - {T_SC: " + braced(T_SC) + ", image_dimension: [752, 480], " + lens +
           ", distortion_type: radialtangential}\n";
  };
  const Rig from_okvis = read("%YAML:1.0\ncameras:\n" +
                              okvis(kBodyLeft,
                                    "focal_length: [458.6, 457.3], principal_point: [367.2, 248.4], "
                                    "distortion_coefficients: [-0.28, 0.07, 0.0002, 0.00002]") +
                              okvis(kBodyRight,
                                    "focal_length: [457.6, 456.1], principal_point: [380, 255.2], "
                                    "distortion_coefficients: [-0.27, 0.06, 0.0003, 0.0001]"));
  expectTransform(from_okvis);
  expectLenses(from_okvis);
  const auto maplab = [](std::string_view T_B_C, const std::string& intrinsics, const std::string& parameters) {
    return "- camera:\n    type: pinhole\n    image_width: 752\n    image_height: 480\n    intrinsics:\n      data: " +
           intrinsics +
           "\n    distortion:\n      type: radial-tangential\n      parameters:\n        data: " + parameters +
           "\n  T_B_C:\n    data: " + braced(T_B_C) + "\n";
  };
  const Rig from_maplab = read("label: rig\ncameras:\n" +
                               maplab(kBodyLeft, "[458.6, 457.3, 367.2, 248.4]", "[-0.28, 0.07, 0.0002, 0.00002]") +
                               maplab(kBodyRight, "[457.6, 456.1, 380, 255.2]", "[-0.27, 0.06, 0.0003, 0.0001]"));
  expectTransform(from_maplab);
  expectLenses(from_maplab);
}

std::string basalt(const std::string& type) {
  return R"({"value0": {"T_imu_cam": [
	{"px": 0, "py": 0, "pz": 0, "qx": 0, "qy": 0, "qz": 0, "qw": 1},
	{"px": 0.11, "py": 0, "pz": 0, "qx": -0.0049999791666927, "qy": 0, "qz": 0, "qw": 0.9999875000260416}],
    "intrinsics": [
      {"camera_type": ")" +
         type +
         R"(", "intrinsics": {"fx": 420.5, "fy": 420.6, "cx": 369.4, "cy": 239.1, "k1": 0.19, "k2": 0.04, "k3": -0.23, "k4": 0.095}},
      {"camera_type": ")" +
         type +
         R"(", "intrinsics": {"fx": 421.2, "fy": 421.4, "cx": 367.7, "cy": 244.4, "k1": 0.19, "k2": 0.05, "k3": -0.24, "k4": 0.1}}],
    "resolution": [[752, 480], [752, 480]], "imu_update_rate": 200.0}})";
}

TEST_F(RigForms, BasaltsJsonHasFishEyeLensesOnABody) {
  const Rig rig = read(basalt("kb4"), "calibration.json");
  expectTransform(rig);
  EXPECT_EQ(rig.left.distortion, Distortion::kEquidistant);
  EXPECT_EQ(rig.left.coefficients[3], 0.095);
  EXPECT_EQ(rig.right.fy_px, 421.4);
  EXPECT_EQ(rig.right.size, (ImageSize{752, 480}));
  EXPECT_THAT(errorOf(basalt("ds"), "calibration.json"), AllOf(HasSubstr("camera_type is ds"), HasSubstr("kb4")));
}

TEST_F(RigForms, VinsNamesAFileForEachCamera) {
  const auto camera = [](const std::string& projection, const std::string& distortion) {
    return "%YAML:1.0\n---\nmodel_type: PINHOLE\nimage_width: 752\nimage_height: 480\ndistortion_parameters:\n" +
           distortion + "projection_parameters:\n" + projection;
  };
  folder_.write("cam0.yaml", camera("   fx: 458.6\n   fy: 457.3\n   cx: 367.2\n   cy: 248.4\n",
                                    "   k1: -0.28\n   k2: 0.07\n   p1: 0.0002\n   p2: 0.00002\n"));
  folder_.write("cam1.yaml", camera("   fx: 457.6\n   fy: 456.1\n   cx: 380\n   cy: 255.2\n",
                                    "   k1: -0.27\n   k2: 0.06\n   p1: 0.0003\n   p2: 0.0001\n"));
  const std::string configuration =
      "%YAML:1.0\nnum_of_cam: 2\ncam0_calib: \"cam0.yaml\"\ncam1_calib: \"cam1.yaml\"\n"
      "body_T_cam0: " +
      matrix(kBodyLeft) + "body_T_cam1: " + matrix(kBodyRight);
  const Rig rig = read(configuration + "estimate_extrinsic: 0\n", "euroc_stereo_config.yaml");
  expectTransform(rig);
  expectLenses(rig);
  EXPECT_THAT(errorOf(configuration + "estimate_extrinsic: 2\n"),
              HasSubstr("body_T_cam0 and body_T_cam1 are not known"));
  EXPECT_THAT(messageOf<InputError>([&] { readRig({folder_ / "cam0.yaml"}); }), HasSubstr("cam0_calib"));
  folder_.write("cam1.yaml", "%YAML:1.0\nmodel_type: MEI\nprojection_parameters:\n   gamma1: 669\n");
  EXPECT_THAT(errorOf(configuration), AllOf(HasSubstr("cam1_calib names what cannot be used"), HasSubstr("is MEI")));
  folder_.write("fish.yaml",
                "model_type: KANNALA_BRANDT\nprojection_parameters: {k2: 0.1, k3: 0.2, k4: 0.3, k5: 0.4, "
                "mu: 458.6, mv: 457.3, u0: 367.2, v0: 248.4}\n");
  const Rig fish = read("cam0_calib: fish.yaml\ncam1_calib: fish.yaml\nbody_T_cam0: " + matrix(kBodyLeft) +
                        "body_T_cam1: " + matrix(kBodyRight));
  EXPECT_EQ(fish.left.distortion, Distortion::kEquidistant);
  EXPECT_EQ(fish.left.coefficients[3], 0.4);
  EXPECT_EQ(fish.left.cy_px, 248.4);
}

std::string settings(const std::string& type, const std::string& first, const std::string& rest) {
  return "%YAML:1.0\nCamera.type: \"" + type + "\"\n" + first + "fx: 458.6\n" + first + "fy: 457.3\n" + first +
         "cx: 367.2\n" + first + "cy: 248.4\nCamera.width: 752\nCamera.height: 480\nCamera.fps: 20\n" + rest;
}

TEST_F(RigForms, OrbSlamsSettingsOfRectifiedPairs) {
  for (const auto& [first, baseline] :
       {std::pair("Camera.", "Camera.bf: 50.446\nThDepth: 35\n"), std::pair("Camera1.", "Stereo.b: 0.11\n")}) {
    const Rig rig = read(settings("Rectified", first, baseline));
    ASSERT_TRUE(rig.rectified);
    EXPECT_NEAR(rig.rectified->baseline_m, 0.11, 1e-12);
    EXPECT_EQ(rig.rectified->cy_px, 248.4);
    EXPECT_THAT(messageOf<InputError>([&] { rectificationOf(rig, {640, 480}); }), HasSubstr("752x480"));
  }
  EXPECT_THAT(errorOf(settings("PinHole", "Camera.", "Camera.k1: -0.28\nCamera.bf: 50.446\n")),
              HasSubstr("nothing tells how to rectify"));
  EXPECT_THAT(errorOf(settings("PinHole", "Camera.", "Camera.bf: 40\nDepthMapFactor: 5000\n")), HasSubstr("RGB-D"));
  EXPECT_THAT(errorOf(settings("PinHole", "Camera.", "")), HasSubstr("settings for one camera"));
  EXPECT_THAT(errorOf(settings("Omni", "Camera.", "Camera.bf: 50\n")), HasSubstr("is Omni"));
}

TEST_F(RigForms, OrbSlamsSettingsWithATransformTakeTheSecondToTheFirst) {
  const std::string second =
      "Camera1.k1: -0.28\nCamera2.fx: 457.6\nCamera2.fy: 456.1\nCamera2.cx: 380\n"
      "Camera2.cy: 255.2\nCamera2.k1: -0.27\nCamera2.p2: 0.0001\n";
  const Rig rig = read(settings("PinHole", "Camera1.", second + "Stereo.T_c1_c2: " + matrix(kLeftRight)));
  expectTransform(rig);
  expectLenses(rig);
  const std::string upper_rows(kLeftRight.substr(0, kLeftRight.rfind(", 0, 0, 0, 1")));
  const std::string fish =
      "Camera.k1: 0.0034\nCamera.k4: 0.0002\nCamera2.fx: 457.6\nCamera2.fy: 456.1\nCamera2.cx: 380\n"
      "Camera2.cy: 255.2\nTlr: " +
      matrix(upper_rows, 3, 4);
  const Rig older = read(settings("KannalaBrandt8", "Camera.", fish));
  EXPECT_EQ(older.left.distortion, Distortion::kEquidistant);
  EXPECT_EQ(older.left.coefficients[3], 0.0002);
  EXPECT_NEAR(older.T_right_left.translation().x(), -0.11, 1e-12);
}

TEST_F(RigForms, SettingsThatRectifyAreFollowed) {
  const std::string K_left = "458.6, 0, 367.2, 0, 457.3, 248.4, 0, 0, 1",
                    K_right = "457.6, 0, 380, 0, 456.1, 255.2, 0, 0, 1";
  const std::string D_left = "-0.28, 0.07, 0.0002, 0.00002, 0", D_right = "-0.27, 0.06, 0.0003, 0.0001, 0";
  const std::string R_left = "1, 0, 0, 0, 1, 0, 0, 0, 1",
                    R_right =
                        "1, 0, 0, 0, 0.99995000041666528, 0.0099998333341666645, 0, -0.0099998333341666645, "
                        "0.99995000041666528";
  const Rig orb =
      read(settings("PinHole", "Camera.",
                    "Camera.bf: 50.446\nLEFT.K: " + matrix(K_left, 3, 3) + "LEFT.D: " + matrix(D_left, 1, 5) +
                        "LEFT.R: " + matrix(R_left, 3, 3) + "RIGHT.K: " + matrix(K_right, 3, 3) +
                        "RIGHT.D: " + matrix(D_right, 1, 5) + "RIGHT.R: " + matrix(R_right, 3, 3)));
  const Rig stella = read(
      "Camera:\n  name: EuRoC\n  setup: stereo\n  model: perspective\n  fx: 458.6\n  fy: 457.3\n  cx: 367.2\n  cy: "
      "248.4\n"
      "  k1: 0.0\n  cols: 752\n  rows: 480\n  focal_x_baseline: 50.446\nStereoRectifier:\n  model: perspective\n  "
      "K_left: " +
      braced(K_left) + "\n  D_left: " + braced(D_left) + "\n  R_left: " + braced(R_left) +
      "\n  K_right: " + braced(K_right) + "\n  D_right: " + braced(D_right) + "\n  R_right: " + braced(R_right) + "\n");
  for (const Rig& rig : {orb, stella}) {
    expectLenses(rig);
    ASSERT_TRUE(rig.given);
    EXPECT_NEAR(rig.given->camera.baseline_m, 0.11, 1e-12);
    EXPECT_NEAR(rig.given->R_right(1, 2), 0.01, 1e-6);
    EXPECT_TRUE(rig.given->R_left.isIdentity());
  }
  EXPECT_THAT(errorOf("Camera: {setup: monocular, fx: 458, fy: 457, cx: 367, cy: 248}\n"), HasSubstr("is monocular"));
}

TEST_F(RigForms, CityscapesCameraIsRectified) {
  const Rig rig = read(R"({"extrinsic": {"baseline": 0.209313, "pitch": 0.038}, "intrinsic":
      {"fx": 2262.52, "fy": 2265.3, "u0": 1096.98, "v0": 513.137}})",
                       "camera.json");
  ASSERT_TRUE(rig.rectified);
  EXPECT_EQ(rig.rectified->baseline_m, 0.209313);
  EXPECT_EQ(rig.rectified->cy_px, 513.137);
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

std::string openCv(const std::string& D1, const std::string& rest = "", const std::string& left = "M1") {
  return left + ": [500, 0, 376, 0, 501, 240, 0, 0, 1]\nM2: [502, 0, 370, 0, 503, 241, 0, 0, 1]\nD1: " + D1 +
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
  EXPECT_THAT(errorOf(openCv("[0, 0, 0, 0, 0]", "M1: 1\n", "K1: [500, 0, 0, 0, 501, 0, 376, 240, 1]\nX")),
              HasSubstr("MATLAB"));
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
}  // namespace motorcade
