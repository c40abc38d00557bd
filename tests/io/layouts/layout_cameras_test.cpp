#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/inputs/sequence_decoder.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/rig/rectification.hpp"
#include "io/sequence/sequence.hpp"
#include "tests/io/layouts/layout_folder.hpp"

/// The calibration of a layout: beside its images, or as the user gives it.
namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

class LayoutCameras : public LayoutFolder {};

TEST_F(LayoutCameras, GivenCameraComesBeforeTheSequencesOwn) {
  writeImage("left/0.png");
  writeImage("right/0.png");
  EXPECT_THAT(openError(), AllOf(HasSubstr("calib.txt"), HasSubstr("P1: fx 0 cx -fx*baseline"), HasSubstr("--camera"),
                                 HasSubstr("camchain.yaml")));
  folder_.write("calib.txt", "P0: 70 0 32 0 0 70 24 0 0 0 1 0\nP1: 70 0 32 -35 0 70 24 0 0 0 1 0\n");
  EXPECT_EQ(openSequence(folder_.path()).camera.baseline_m, 0.5);
  EXPECT_EQ(openSequence(folder_.path(), 10, {.camera = "50,50,32,24,0.2"}).camera.baseline_m, 0.2);
  const auto other = folder_.write("other.txt", "P2: 80 0 32 0 0 80 24 0 0 0 1 0\nP3: 80 0 32 -8 0 80 24 0 0 0 1 0\n");
  const Sequence sequence = openSequence(folder_.path(), 10, {.calibration = other.string()});
  EXPECT_EQ(sequence.camera.baseline_m, 0.1);
  EXPECT_EQ(sequence.given.calibration, other.string());
  for (const char* bad : {"50,50,32,24", "50,50,32,24,0.2,1", "50,50,32,24,-0.2", "50,50,32,x,0.2", "a"})
    EXPECT_THAT(messageOf<UsageError>([&] { openSequence(folder_.path(), 10, {.camera = bad}); }),
                HasSubstr("fx,fy,cx,cy,baseline"));
  EXPECT_THROW(openSequence(folder_.path(), 10, {.camera = "1,1,1,1,1", .calibration = "x"}), UsageError);
  EXPECT_THAT(openError("", {.calibration = "nowhere.yaml"}), HasSubstr("nowhere.yaml"));
}

TEST_F(LayoutCameras, CalibrationBesidePlainFoldersRectifiesThem) {
  for (const char* side : {"cam0", "cam1"}) writeImage(std::string(side) + "/0.png");
  const std::string camera =
      "  camera_model: pinhole\n  intrinsics: [50, 50, 31, 24]\n  distortion_model: radtan\n"
      "  distortion_coeffs: [-0.2, 0.03, 0, 0]\n  resolution: [64, 48]\n";
  folder_.write("camchain.yaml", "cam0:\n" + camera + "cam1:\n" + camera +
                                     "  T_cn_cnm1: [[1, 0, 0, -0.2], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n");
  const Sequence beside = openSequence(folder_.path());
  ASSERT_TRUE(beside.rectification);
  EXPECT_NEAR(beside.camera.baseline_m, 0.2, 1e-12);
  std::filesystem::rename(folder_ / "camchain.yaml", folder_ / "elsewhere.yaml");
  EXPECT_THAT(openError(), HasSubstr("--calibration"));
  const Sequence given = openSequence(folder_.path(), 10, {.calibration = (folder_ / "elsewhere.yaml").string()});
  EXPECT_EQ(given.camera.fx_px, beside.camera.fx_px);
}

std::string openCv(const std::string& x_m) {
  return "M1: [50, 0, 31, 0, 50, 24, 0, 0, 1]\nM2: [50, 0, 31, 0, 50, 24, 0, 0, 1]\nD1: [0, 0, 0, 0, 0]\n"
         "D2: [0, 0, 0, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [" +
         x_m + ", 0, 0]\n";
}

TEST_F(LayoutCameras, CalibrationInForceIsKnownWhereverItIsFrom) {
  for (const char* side : {"left", "right"}) writeImage(std::string(side) + "/0.png");
  const auto stereo = folder_.write("stereo.yaml", openCv("-0.2"));
  EXPECT_EQ(openSequence(folder_.path()).calibrated_by, stereo);
  folder_.write("older/stereo.yaml", openCv("-0.1"));
  const Sequence given = openSequence(folder_.path(), 10, {.calibration = (folder_ / "older").string()});
  EXPECT_EQ(given.calibrated_by, folder_ / "older/stereo.yaml");
  EXPECT_NEAR(given.camera.baseline_m, 0.1, 1e-12);
  EXPECT_EQ(openSequence(folder_.path(), 10, {.camera = "50,50,32,24,0.2"}).calibrated_by, "");
  const auto second = folder_.write("stereo-2.yaml", openCv("-0.3"));
  EXPECT_THAT(openError(),
              AllOf(HasSubstr("2 calibrations, which differ"), HasSubstr("--calibration " + second.string())));
  EXPECT_NEAR(openSequence(folder_.path(), 10, {.calibration = second.string()}).camera.baseline_m, 0.3, 1e-12);
  const auto calib = folder_.write("calib.txt", "P0: 70 0 32 0 0 70 24 0 0 0 1 0\nP1: 70 0 32 -35 0 70 24 0 0 0 1 0\n");
  EXPECT_EQ(openSequence(folder_.path()).calibrated_by, calib);
  EXPECT_EQ(openSequence(folder_.path(), 10, {.calibration = folder_.path().string()}).calibrated_by, calib);
  std::filesystem::create_directories(folder_ / "empty");
  EXPECT_THAT(openError("", {.calibration = (folder_ / "empty").string()}), HasSubstr("holds no calibration"));
}

TEST_F(LayoutCameras, CalibrationOfAnUnusualNameIsOffered) {
  for (const char* side : {"left", "right"}) writeImage("my drive/" + std::string(side) + "/0.png");
  folder_.write("my drive/rig.yaml", openCv("-0.2"));
  EXPECT_THAT(openError("my drive"), HasSubstr("--calibration '" + (folder_ / "my drive/rig.yaml").string() + "'"));
}

TEST_F(LayoutCameras, RightImageIsMovedWhereTheMiddlesDiffer) {
  writeImage("left/0.png");
  Image right = pool_.acquire(64, 48);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) right.mutableRow(y)[x] = static_cast<std::uint8_t>(3 * x);
  std::filesystem::create_directories(folder_ / "right");
  writePng(folder_ / "right/0.png", right);
  folder_.write("calib.txt", "P0: 70 0 36 0 0 70 24 0 0 0 1 0\nP1: 70 0 32 -35 0 70 24 0 0 0 1 0\n");
  const Sequence sequence = openSequence(folder_.path());
  EXPECT_EQ(sequence.camera.cx_px, 36);
  EXPECT_EQ(sequence.camera.baseline_m, 0.5);
  SequenceDecoder decoder(sequence, {});
  const auto pair = decoder.next();
  EXPECT_EQ(pair->left.at(20, 10), 77);
  EXPECT_EQ(pair->right.at(20, 10), 3 * 16);  // what lay 4 px from the middle on does so still
}

TEST_F(LayoutCameras, ProjectionsOfAnotherSizeAreRefused) {
  for (const char* side : {"left", "right"}) writeImage(std::string(side) + "/0.png");
  folder_.write("calib.txt",
                "S_rect_00: 1242 375\nP0: 70 0 32 0 0 70 24 0 0 0 1 0\nP1: 70 0 32 -35 0 70 24 0 0 0 1 0\n");
  EXPECT_THAT(openError(), AllOf(HasSubstr("1242x375"), HasSubstr("64x48")));
}

}  // namespace
}  // namespace motorcade
