#include <string>
#include <utility>

#include "tests/io/rig/rig_forms.hpp"

/// Forms of systems that use calibrations: OKVIS, maplab, Basalt, VINS, ORB-SLAM, stella_vslam, Cityscapes.
namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class RigSystems : public RigForms {};

TEST_F(RigSystems, ListsOfPlacedCamerasAreOkvisAndMaplabs) {
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
         R"(", "intrinsics": {"fx": 420.5, "fy": 420.6, "cx": 369.4, "cy": 239.1,
        "k1": 0.19, "k2": 0.04, "k3": -0.23, "k4": 0.095}},
      {"camera_type": ")" +
         type +
         R"(", "intrinsics": {"fx": 421.2, "fy": 421.4, "cx": 367.7, "cy": 244.4,
        "k1": 0.19, "k2": 0.05, "k3": -0.24, "k4": 0.1}}],
    "resolution": [[752, 480], [752, 480]], "imu_update_rate": 200.0}})";
}

TEST_F(RigSystems, BasaltsJsonHasFishEyeLensesOnABody) {
  const Rig rig = read(basalt("kb4"), "calibration.json");
  expectTransform(rig);
  EXPECT_EQ(rig.left.distortion, Distortion::kEquidistant);
  EXPECT_EQ(rig.left.coefficients[3], 0.095);
  EXPECT_EQ(rig.right.fy_px, 421.4);
  EXPECT_EQ(rig.right.size, (ImageSize{752, 480}));
  EXPECT_THAT(errorOf(basalt("ds"), "calibration.json"), AllOf(HasSubstr("camera_type is ds"), HasSubstr("kb4")));
}

TEST_F(RigSystems, VinsNamesAFileForEachCamera) {
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

TEST_F(RigSystems, OrbSlamsSettingsOfRectifiedPairs) {
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

TEST_F(RigSystems, OrbSlamsSettingsWithATransformTakeTheSecondToTheFirst) {
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

TEST_F(RigSystems, SettingsThatRectifyAreFollowed) {
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

TEST_F(RigSystems, CityscapesCameraIsRectified) {
  const Rig rig = read(R"({"extrinsic": {"baseline": 0.209313, "pitch": 0.038}, "intrinsic":
      {"fx": 2262.52, "fy": 2265.3, "u0": 1096.98, "v0": 513.137}})",
                       "camera.json");
  ASSERT_TRUE(rig.rectified);
  EXPECT_EQ(rig.rectified->baseline_m, 0.209313);
  EXPECT_EQ(rig.rectified->cy_px, 513.137);
}

}  // namespace
}  // namespace motorcade::test
