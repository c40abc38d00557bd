#include "io/sequence/calibration.hpp"

#include <string>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

/// Focal length 700 px; the gray pair 0.5 m apart, the color pair 0.6 m.
constexpr std::string_view kProjections =
    "P0: 700 0 320 0 0 710 100 0 0 0 1 0\n"
    "P1: 700 0 320 -350 0 710 100 0 0 0 1 0\n"
    "P2: 700 0 320 70 0 710 100 0 0 0 1 0\n"
    "P3: 700 0 320 -350 0 710 100 0 0 0 1 0\n";

class CalibrationFile : public testing::Test {
 protected:
  Calibration read(const std::string& content) { return readCalibration(folder_.write("calib.txt", content)); }
  std::string errorOf(const std::string& content, CameraPair pair = CameraPair::kGray) {
    return messageOf<InputError>([&] { read(content).stereoCamera(pair); });
  }

  test::TemporaryFolder folder_;
};

TEST_F(CalibrationFile, GivesIntrinsicsAndBaselineOfEachPair) {
  const Calibration calibration = read(std::string(kProjections));
  const StereoCamera gray = calibration.stereoCamera(CameraPair::kGray);
  EXPECT_DOUBLE_EQ(gray.fx_px, 700);
  EXPECT_DOUBLE_EQ(gray.fy_px, 710);
  EXPECT_DOUBLE_EQ(gray.cx_px, 320);
  EXPECT_DOUBLE_EQ(gray.cy_px, 100);
  EXPECT_DOUBLE_EQ(gray.baseline_m, 0.5);
  EXPECT_DOUBLE_EQ(calibration.stereoCamera(CameraPair::kColor).baseline_m, 0.6);
}

TEST_F(CalibrationFile, MayTellHowExactItIs) {
  EXPECT_FALSE(read(std::string(kProjections)).sigmas);
  const auto sigmas = read(std::string(kProjections) + "calibration_sigmas: 0.001 0.5 0.02 0 0.3\n").sigmas;
  EXPECT_EQ(sigmas, (CalibrationSigmas{0.001, 0.5, 0.02, 0, 0.3}));
  EXPECT_THAT(errorOf(std::string(kProjections) + "calibration_sigmas: 0.001 0.5 0.02 -1 0.3\n"),
              AllOf(HasSubstr("calib.txt, line 5: key calibration_sigmas"), HasSubstr("number 4, of 'baseline'")));
  EXPECT_THAT(errorOf(std::string(kProjections) + "calibration_sigmas: 0\n"), HasSubstr("calibration_sigmas"));
}

TEST_F(CalibrationFile, TellsWhereTheLeftColorCameraStands) {
  const Calibration calibration = read(std::string(kProjections));
  EXPECT_TRUE(calibration.T_left_cam0(CameraPair::kGray).translation().isZero());
  EXPECT_TRUE(calibration.T_left_cam0(CameraPair::kColor).translation().isApprox(Eigen::Vector3d(0.1, 0, 0)));
}

TEST_F(CalibrationFile, TakesBothSpellingsOfItsKeys) {
  const std::string rotation = " 1 0 0 0 1 0 0 0 1\n", rigid = " 1 0 0 4 0 1 0 5 0 0 1 6\n";
  const Calibration tracking =
      read("R_rect" + rotation + "Tr_velo_cam" + rigid + "Tr_imu_velo" + rigid + std::string(kProjections));
  const Calibration raw = read("P_rect_00: 700 0 320 0 0 710 100 0 0 0 1 0\nR0_rect:" + rotation +
                               "Tr_velo_to_cam:" + rigid + "Tr_imu_to_velo:" + rigid);
  ASSERT_TRUE(tracking.T_cam0_imu() && raw.T_cam0_imu());
  EXPECT_TRUE(tracking.T_cam0_imu()->translation().isApprox(Eigen::Vector3d(8, 10, 12)));
  EXPECT_TRUE(raw.T_cam0_imu()->translation().isApprox(Eigen::Vector3d(8, 10, 12)));
  EXPECT_TRUE(raw.P[0].has_value());
}

TEST_F(CalibrationFile, KnowsNoInertialUnitWhenAPartOfTheChainIsMissing) {
  EXPECT_FALSE(read(std::string(kProjections)).T_cam0_imu().has_value());
  EXPECT_FALSE(read("R_rect 1 0 0 0 1 0 0 0 1\n").T_cam0_imu().has_value());
}

TEST_F(CalibrationFile, PassesOverTheTimeOfTheCalibration) {
  EXPECT_NO_THROW(read("calib_time: 09-Jan-2012 13:57:47\n" + std::string(kProjections)));
}

TEST_F(CalibrationFile, PassesOverCommentsTextsAndPunctuation) {
  const StereoCamera camera = read(
                                  "# rectified, 2024-05-01\n// by hand\nname: front stereo\n"
                                  "P0: 700, 0, 320, 0,  0, 710, 100, 0,  0, 0, 1, 0  # left\n"
                                  "P1 = [700 0 320 -350; 0 710 100 0; 0 0 1 0]\n")
                                  .stereoCamera(CameraPair::kGray);
  EXPECT_EQ(camera.fy_px, 710);
  EXPECT_EQ(camera.baseline_m, 0.5);
}

TEST_F(CalibrationFile, MiddlesOfBothImagesMayDiffer) {
  const std::string left = "P0: 721.5 0 620.5 0 0 721.5 187 0 0 0 1 0\n";
  const Calibration moved = read(left + "P1: 721.5 0 600.5 -389.61 0 721.5 187 0 0 0 1 0\n");
  EXPECT_EQ(moved.stereoCamera(CameraPair::kGray).cx_px, 620.5);
  EXPECT_NEAR(moved.stereoCamera(CameraPair::kGray).baseline_m, 0.54, 1e-12);
  EXPECT_EQ(moved.rightMiddle_px(CameraPair::kGray), 600.5);
  const Calibration rounded = read(left + "P1: 721.5 0 620.51 -389.61 0 721.5 187 0 0 0 1 0\n");
  EXPECT_EQ(rounded.rightMiddle_px(CameraPair::kGray), 620.5);
}

TEST_F(CalibrationFile, ReadsMiddleburysMatricesAndMillimeters) {
  const Calibration calibration = read(
      "cam0=[3997.684 0 1176.728; 0 3997.684 1011.728; 0 0 1]\ncam1=[3997.684 0 1307.839; 0 3997.684 1011.728; 0 0 1]\n"
      "doffs=131.111\nbaseline=193.001\nwidth=2964\nheight=1988\nndisp=280\n");
  EXPECT_NEAR(calibration.stereoCamera(CameraPair::kGray).baseline_m, 0.193001, 1e-12);
  EXPECT_EQ(calibration.stereoCamera(CameraPair::kGray).cy_px, 1011.728);
  EXPECT_EQ(calibration.rightMiddle_px(CameraPair::kGray), 1307.839);
  EXPECT_EQ(calibration.rectifiedSize(CameraPair::kGray), (ImageSize{2964, 1988}));
}

TEST_F(CalibrationFile, WithoutProjectionsSaysWhatItIsAndWhatToDo) {
  const std::string p0 = ": 700 0 320 0 0 710 100 0 0 0 1 0\n", p1 = ": 700 0 320 -350 0 710 100 0 0 0 1 0\n";
  const auto named = [&](std::string left, const std::string& right) {
    return left.append(p0).append(right).append(p1);
  };
  for (const auto& [content, advice] :
       {std::pair(named("p0", "p1"), std::string("it has p0, p1: call the left camera's projection P0")),
        std::pair(named("P_rect_101", "P_rect_103"), std::string("it has P_rect_101, P_rect_103: call")),
        std::pair(std::string("K: 721.5 0 620.5 0 721.5 187 0 0 1\n"), std::string("its K tells no baseline")),
        std::pair(std::string("f: 645.2\ncu: 635.9\ncv: 194.1\nbase: 0.57\n"),
                  std::string("--camera 645.2,645.2,635.9,194.1,0.57")),
        std::pair(std::string("cam0:\n  intrinsics: [1, 2, 3, 4]\n"), std::string("end in .yaml")),
        std::pair(std::string("700 0 320 0 0 710 100 0 0 0 1 0\n"), std::string("write P0: fx 0 cx 0"))})
    EXPECT_THAT(errorOf(content), AllOf(HasSubstr("calib.txt: has no P0 and P1; "), HasSubstr(advice))) << content;
  EXPECT_THAT(errorOf("Pinhole 501.4 501.4 421.7 167.6 0 0 0 0\n800 400\ncrop\n800 400\n"),
              AllOf(HasSubstr("DSO's"), HasSubstr("--camera")));
  EXPECT_THAT(errorOf(named("P0", "P1"), CameraPair::kColor), HasSubstr("has no P2 and P3"));
}

TEST_F(CalibrationFile, RefusesTwoValuesOfOneKey) {
  const std::string projections(kProjections);
  EXPECT_NO_THROW(read(projections + projections));
  EXPECT_THAT(errorOf(projections + "P1: 700 0 320 -378 0 710 100 0 0 0 1 0\n"),
              HasSubstr("line 2: key P1 is given once more in line 5"));
}

TEST_F(CalibrationFile, NamesTheKeyThatIsMissingOrHasTheWrongLength) {
  EXPECT_THAT(errorOf("P0: 700 0 320 0 0 710 100 0 0 0 1 0\n"), AllOf(HasSubstr("calib.txt"), HasSubstr("key P1")));
  EXPECT_THAT(errorOf(std::string(kProjections.substr(0, kProjections.find("P3"))), CameraPair::kColor),
              HasSubstr("key P3 is missing; the images are those of cameras 2 and 3"));
  EXPECT_THAT(errorOf("\nP0: 1 2 3\n"), HasSubstr("calib.txt, line 2: key P0 has 3 numbers, 12 are needed"));
  EXPECT_THAT(errorOf("P0: 700 zero\n"), AllOf(HasSubstr("line 1"), HasSubstr("'zero' is not a number (P0)")));
}

TEST_F(CalibrationFile, RefusesPairsThatCannotBeUsed) {
  const std::string left = "P0: 700 0 320 0 0 710 100 0 0 0 1 0\n";
  EXPECT_THAT(errorOf("P0: 0 0 320 0 0 710 100 0 0 0 1 0\nP1: 0 0 320 -350 0 710 100 0 0 0 1 0\n"),
              HasSubstr("calib.txt, line 1: key P0: the focal lengths must be positive"));
  EXPECT_THAT(errorOf("P0: 1e20 0 320 0 0 710 100 0 0 0 1 0\nP1: 1e20 0 320 -350 0 710 100 0 0 0 1 0\n"),
              HasSubstr("line 1: key P0: a focal length is"));
  EXPECT_THAT(errorOf(left + "P1: 700 0 320 -350 0 710 104 0 0 0 1 0\n"), HasSubstr("the pair is not rectified"));
  EXPECT_THAT(errorOf(left + "P1: 720 0 320 -350 0 710 100 0 0 0 1 0\n"), HasSubstr("the pair is not rectified"));
  EXPECT_THAT(errorOf(left + "P1: 700 0 620 -350 0 710 100 0 0 0 1 0\n"), HasSubstr("differ by 300"));
  EXPECT_THAT(errorOf("P0: 700 0 320 0 0 700 100 0 0 0 0 0\nP1: 700 0 320 -350 0 700 100 0 0 0 0 0\n"),
              HasSubstr("must be fx 0 cx, 0 fy cy, 0 0 1"));
  EXPECT_THAT(errorOf(left + "P1: 700 0 320 350 0 710 100 0 0 0 1 0\n"), HasSubstr("are left and right swapped?"));
}

TEST_F(CalibrationFile, RefusesWhatIsNoRotation) {
  const std::string projections(kProjections);
  EXPECT_THAT(errorOf("R0_rect: 0 0 0 0 0 0 0 0 0\n" + projections),
              HasSubstr("calib.txt, line 1: key R0_rect holds no rotation matrix"));
  EXPECT_THAT(errorOf(projections + "Tr_velo_to_cam: 1 0 0 4 0 1 0 5 0 0 -1 6\n"),
              HasSubstr("calib.txt, line 5: key Tr_velo_to_cam holds no rotation matrix"));
}

TEST_F(CalibrationFile, RefusesAFileThatIsTooLarge) {
  EXPECT_THAT(errorOf(std::string(2'000'000, '\n')), HasSubstr("is too large (2000000 bytes, at most 1048576)"));
}

TEST_F(CalibrationFile, JoinsTheThreeFilesOfARawDate) {
  folder_.write("calib_cam_to_cam.txt", "R_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_00: 700 0 320 0 0 710 100 0 0 0 1 0\n");
  folder_.write("calib_velo_to_cam.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 1 2 3\n");
  EXPECT_FALSE(readRawCalibration(folder_.path()).T_cam0_imu().has_value());
  folder_.write("calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 10 20 30\n");
  const auto T_cam0_imu = readRawCalibration(folder_.path()).T_cam0_imu();
  ASSERT_TRUE(T_cam0_imu.has_value());
  EXPECT_TRUE(T_cam0_imu->translation().isApprox(Eigen::Vector3d(11, 22, 33)));
  folder_.write("calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\n");
  EXPECT_THAT(messageOf<InputError>([&] { readRawCalibration(folder_.path()); }), HasSubstr("key R or T is missing"));
}

}  // namespace
}  // namespace motorcade
