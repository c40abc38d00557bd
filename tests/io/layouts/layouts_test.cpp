#include <numbers>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/inputs/sequence_decoder.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/rig/rectification.hpp"
#include "io/sequence/sequence.hpp"
#include "io/truth/ground_truth.hpp"
#include "tests/io/layouts/layout_folder.hpp"

/// Layouts other than KITTI's, made small; `sequence_test` has those.
namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A camera whose x axis is the body's y axis, at (x, y, 0) on the body.
std::string sensorFile(const std::string& x_m, const std::string& y_m, const std::string& size = "[64, 48]") {
  return "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0, -1, 0, " + x_m + ",\n    1, 0, 0, " +
         y_m + ",\n    0, 0, 1, 0,\n    0, 0, 0, 1]\nrate_hz: 20\nresolution: " + size +
         "\ncamera_model: pinhole\nintrinsics: [50, 50, 31, 24] #fu, fv, cu, cv\n"
         "distortion_model: radial-tangential\ndistortion_coefficients: [-0.2, 0.03, 0, 0]\n";
}

class Layouts : public LayoutFolder {
 protected:
  /// Two cameras 0.1 m apart along the body's y axis. The right one misses an image, and has one too many.
  void writeEuroc() {
    for (const char* name : {"100", "150", "200", "250"})
      writeImage("mav0/cam0/data/" + std::string(name) + "000000.png");
    for (const char* name : {"100", "200", "250", "300"})
      writeImage("mav0/cam1/data/" + std::string(name) + "000000.png");
    folder_.write("mav0/cam0/data.csv",
                  "#timestamp [ns],filename\r\n100000000,100000000.png\r\n150000000,150000000.png\r\n"
                  "200000000,200000000.png\r\n250000000,250000000.png\r\n");
    folder_.write("mav0/cam1/data.csv",
                  "#timestamp [ns],filename\n100000000,100000000.png\n200000900,200000000.png\n"
                  "250000000,250000000.png\n300000000,300000000.png\n");
    folder_.write("mav0/cam0/sensor.yaml", sensorFile("0.05", "0"));
    folder_.write("mav0/cam1/sensor.yaml", sensorFile("0.05", "0.1"));
  }
};

TEST_F(Layouts, EurocPairsAreMatchedByTimeAndRectified) {
  writeEuroc();
  for (const char* name : {"", "mav0", "mav0/"}) {
    const Sequence sequence = openSequence(folder_ / name);
    EXPECT_EQ(sequence.layout, "euroc");
    ASSERT_EQ(sequence.frames.size(), 4U);
    EXPECT_TRUE(sequence.frames[1].right_missing);
    EXPECT_EQ(sequence.stamps[2].ns, 200'000'000);
    EXPECT_EQ(sequence.frames[2].right.filename(), "200000000.png");
    EXPECT_EQ(sequence.left_out, 1);  // the right one after the last pair
    EXPECT_EQ(sequence.notes.size(), 2U);
    ASSERT_TRUE(sequence.rectification);
    EXPECT_NEAR(sequence.camera.baseline_m, 0.1, 1e-12);
    EXPECT_EQ(sequence.camera.width_px, 64);
  }
}

TEST_F(Layouts, DecoderGivesRectifiedPairsAndRejectsWhatIsDamaged) {
  writeEuroc();
  folder_.write("mav0/cam0/data/200000000.png", "no image");
  SequenceDecoder decoder(openSequence(folder_.path()), {});
  const auto first = decoder.next(), missing = decoder.next(), third = decoder.next();
  EXPECT_EQ(first->left.width(), 64);
  EXPECT_EQ(first->left.at(32, 24), 77);
  EXPECT_EQ(first->right.at(63, 47), 77);
  EXPECT_THAT(missing->problem, AllOf(HasSubstr("cam1/data/150000000.png"), HasSubstr("is missing")));
  EXPECT_THAT(third->problem, HasSubstr("200000000.png"));
}

TEST_F(Layouts, EurocTruthIsThatOfTheRectifiedLeftCamera) {
  writeEuroc();
  const std::string quarter_turn = ",0.70710678118654752,0,0,0.70710678118654752\n";  // about z
  folder_.write("mav0/state_groundtruth_estimate0/data.csv",
                "#timestamp, p_RS_R_x [m], ...\n150000000,0,0,0,1,0,0,0,9,9\n200000000,1,0,0,1,0,0,0,9,9\n"
                "260000000,1,2,0" +
                    quarter_turn);
  const Sequence sequence = openSequence(folder_.path());
  const auto truth = readCameraTruth(sequence);
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->first_frame, 1);  // of the frame at 100 ms nothing is known
  ASSERT_EQ(truth->T_world_cam.size(), 4U);
  // The body's x is the camera's -y: one meter ahead of the body is one meter up in the image.
  const SE3& at_first = truth->T_world_cam[1];
  EXPECT_NEAR(at_first.translation().norm(), 0, 1e-12);
  const SE3 T_body_left(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
                        {0.05, 0, 0});
  const SE3 T_body_cam = T_body_left * SE3(sequence.rectification->R_left.transpose(), Eigen::Vector3d::Zero());
  const double part = 50.0 / 60;
  const SE3 T_body_now(expSO3({0, 0, part * std::numbers::pi / 2}), {0, 2 * part, 0});
  const SE3 expected = T_body_cam.inverse() * T_body_now * T_body_cam;
  const SE3 motion = truth->T_world_cam[2].inverse() * truth->T_world_cam[3];
  EXPECT_NEAR((motion.inverse() * expected).log().norm(), 0, 1e-9);
}

TEST_F(Layouts, PosesOfTheLeftCameraComeBeforeTheBodys) {
  writeEuroc();
  folder_.write("poses_left_camera.csv", "#timestamp\n90000000,0,0,0,1,0,0,0\n400000000,0,0,3.1,1,0,0,0\n");
  const auto truth = readCameraTruth(openSequence(folder_.path()));
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->first_frame, 0);
  // 150 ms at 10 m/s along the raw camera's axis.
  EXPECT_NEAR(truth->T_world_cam[3].translation().norm(), 1.5, 1e-9);
  folder_.write("poses_left_camera.csv", "1,0,0,0,1,0,0,0\n2,0,0,0,1,0,0,0\n");
  EXPECT_THAT(messageOf<InputError>([&] { readCameraTruth(openSequence(folder_.path())); }),
              AllOf(HasSubstr("poses_left_camera.csv"), HasSubstr("no poses of the time")));
}

TEST_F(Layouts, EurocsMistakesAreNamed) {
  writeEuroc();
  folder_.write("mav0/cam0/sensor.yaml", sensorFile("0.05", "0", "[752, 480]"));
  EXPECT_THAT(openError(), AllOf(HasSubstr("sensor.yaml"), HasSubstr("752x480"), HasSubstr("64x48")));
  std::filesystem::remove(folder_ / "mav0/cam1/sensor.yaml");
  EXPECT_THAT(openError(), HasSubstr("cam1/sensor.yaml"));
  folder_.write("mav0/cam1/data.csv", "#\n1,a.png\n");
  EXPECT_THAT(openError(), HasSubstr("no"));
  folder_.write("mav0/cam1/data.csv", "x,a.png\n");
  EXPECT_THAT(openError(), AllOf(HasSubstr("data.csv"), HasSubstr("line 1")));
}

TEST_F(Layouts, Kitti360HasTimesAndPosesByTheNumbersOfItsImages) {
  const std::string drive = "data_2d_raw/2013_05_28_drive_0002_sync/";
  for (const char* name : {"0000000002", "0000000003", "0000000005"})
    for (const char* side : {"image_00", "image_01"}) writeImage(drive + side + "/data_rect/" + name + ".png");
  writeImage(drive + "image_00/data_rect/0000000007.png");  // without partner
  folder_.write(drive + "image_00/timestamps.txt",
                "2013-05-28 08:46:02.0\n2013-05-28 08:46:02.1\n2013-05-28 08:46:02.2\n2013-05-28 08:46:02.3\n"
                "2013-05-28 08:46:02.4\n2013-05-28 08:46:02.5\n");
  folder_.write("calibration/perspective.txt",
                "calib_time: now\nS_00: 64 48\nP_rect_00: 55.2 0 32 0 0 55.2 24 0 0 0 1 0\n"
                "R_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_01: 55.2 0 32 -33.12 0 55.2 24 0 0 0 1 0\n");
  folder_.write("data_poses/2013_05_28_drive_0002_sync/cam0_to_world.txt",
                "2 1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1\n4 1 0 0 9 0 1 0 0 0 0 1 0 0 0 0 1\n"
                "5 1 0 0 5 0 1 0 0 0 0 1 3 0 0 0 1\n");
  const Sequence sequence = openSequence(folder_ / drive);
  EXPECT_EQ(sequence.layout, "kitti360");
  ASSERT_EQ(sequence.frames.size(), 3U);
  EXPECT_EQ(sequence.stamps[2].ns - sequence.stamps[1].ns, 200'000'000);
  EXPECT_NEAR(sequence.camera.baseline_m, 0.6, 1e-12);
  const auto truth = readCameraTruth(sequence);
  ASSERT_TRUE(truth);
  EXPECT_NEAR(truth->T_world_cam[1].translation().z(), 1, 1e-6);  // between those of 2 and 5
  EXPECT_NEAR(truth->T_world_cam[2].translation().z(), 3, 1e-9);
  std::filesystem::remove(folder_ / "calibration/perspective.txt");
  EXPECT_THAT(openError(drive), HasSubstr("perspective.txt"));
  EXPECT_EQ(openSequence(folder_ / drive, 10, {.camera = "55,55,32,24,0.6"}).camera.fx_px, 55);
}

std::string argoverseCamera(const std::string& name, const std::string& translation) {
  return R"({"key": "image_raw_)" + name + R"(", "value": {"focal_length_x_px_": 60, "focal_length_y_px_": 60,
    "focal_center_x_px_": 32, "focal_center_y_px_": 24, "skew_": 0, "distortion_coefficients_": [0, 0, 0],
    "vehicle_SE3_camera_": {"rotation": {"coefficients": [0.5, -0.5, 0.5, -0.5]}, "translation": )" +
         translation + "}}}";
}

TEST_F(Layouts, ArgoverseLogHasItsCamerasOnTheVehicleAndTimesInItsNames) {
  for (const char* time : {"315971000000000100", "315971000200000100"}) {
    writeImage("log/stereo_front_left_rect/stereo_front_left_rect_" + std::string(time) + ".png");
    writeImage("log/stereo_front_right_rect/stereo_front_right_rect_" + std::string(time) + ".png");
  }
  const std::string left = argoverseCamera("stereo_front_left_rect", "[1.6, 0.15, 1.4]");
  folder_.write("log/vehicle_calibration_stereo_info.json",
                R"({"camera_data_": [)" + argoverseCamera("ring_front_center", "[0, 0, 0]") + "," + left + "," +
                    argoverseCamera("stereo_front_right_rect", "[1.6, -0.15, 1.4]") + "]}");
  const Sequence sequence = openSequence(folder_ / "log");
  EXPECT_EQ(sequence.layout, "argoverse");
  EXPECT_EQ(sequence.stamps[1].ns - sequence.stamps[0].ns, 200'000'000);
  EXPECT_NEAR(sequence.camera.baseline_m, 0.3, 1e-12);
  EXPECT_EQ(sequence.camera.cx_px, 32);
  folder_.write("log/vehicle_calibration_stereo_info.json", R"({"camera_data_": [)" + left + "]}");
  EXPECT_THAT(openError("log"),
              AllOf(HasSubstr("vehicle_calibration_stereo_info.json"), HasSubstr("image_raw_stereo_front_right_rect")));
  folder_.write("log/vehicle_calibration_stereo_info.json", "{");
  EXPECT_THAT(openError("log"), HasSubstr("vehicle_calibration_stereo_info.json"));
}

TEST_F(Layouts, ImageListIsASequenceWithACamera) {
  for (const char* name : {"a.png", "b.png", "c.png", "d.png"}) writeImage("images/" + std::string(name));
  folder_.write("list.txt", "# pairs\nimages/a.png images/b.png\n\n  images/c.png\timages/d.png\n");
  const GivenCameras camera{.camera = "60,61,32,24,0.25"};
  const Sequence plain = openSequence(folder_ / "list.txt", 20, camera);
  EXPECT_EQ(plain.layout, "list");
  EXPECT_EQ(plain.frames[1].right, folder_ / "images/d.png");
  EXPECT_EQ(plain.stamps[1].ns, 50'000'000);
  EXPECT_EQ(plain.camera.fy_px, 61);
  EXPECT_EQ(plain.camera.baseline_m, 0.25);
  EXPECT_EQ(plain.camera.width_px, 64);
  const auto second_ns = [&](const std::string& first, const std::string& second) {
    folder_.write("list.txt", first + ",images/a.png, images/b.png\n" + second + ",images/c.png, images/d.png\n");
    const Sequence stamped = openSequence(folder_ / "list.txt", 20, camera);
    EXPECT_TRUE(stamped.stamps_measured);
    return stamped.stamps[1].ns;
  };
  EXPECT_EQ(second_ns("12.5", "12.75"), 12'750'000'000);
  EXPECT_EQ(second_ns("12", "13"), 13'000'000'000);
  EXPECT_EQ(second_ns("1403715274312143104", "1403715274362142976"), 1403715274362142976);
  EXPECT_EQ(second_ns("0", "50000000"), 50'000'000);
  EXPECT_THAT(messageOf<InputError>([&] { second_ns("13", "12"); }), AllOf(HasSubstr("list.txt"), HasSubstr("line 2")));
  EXPECT_THAT(openError("list.txt"), AllOf(HasSubstr("--camera"), HasSubstr("calib.txt")));
  folder_.write("list.txt", "images/a.png images/b.png\n1 images/c.png images/d.png\n");
  EXPECT_THAT(openError("list.txt", camera), AllOf(HasSubstr("line 2"), HasSubstr("STAMP LEFT RIGHT")));
}

TEST_F(Layouts, UnknownFolderIsDescribedAndToldHowToUseIt) {
  writeImage("port/1.png");
  writeImage("port/2.png");
  writeImage("starboard/1.png");
  folder_.write("rig.yaml", "a: 1\n");
  folder_.write("imu/data.csv", "");
  EXPECT_THAT(openError(), AllOf(HasSubstr("holds no stereo sequence"), HasSubstr("port (2 images)"),
                                 HasSubstr("starboard (1 image)"), HasSubstr("rig.yaml"),
                                 HasSubstr("ln -s " + (folder_ / "starboard").string() + " DRIVE/right"),
                                 HasSubstr("--camera fx,fy,cx,cy,baseline"), Not(HasSubstr("bag"))));
}

TEST_F(Layouts, FolderOfSequencesNamesThem) {
  writeImage("drives/first/left/0.png");
  writeImage("drives/first/right/0.png");
  folder_.write("drives/first/calib.txt", "P0: 70 0 32 0 0 70 24 0 0 0 1 0\nP1: 70 0 32 -35 0 70 24 0 0 0 1 0\n");
  writeImage("drives/second/left/0.png");
  EXPECT_THAT(openError("drives"), AllOf(HasSubstr("are sequences: first."), Not(HasSubstr("ln -s"))));
  writeImage("mixed/left_0.png");
  writeImage("mixed/right_0.png");
  EXPECT_THAT(openError("mixed"), AllOf(HasSubstr("it holds 2 images"),
                                        HasSubstr("-t DRIVE/right " + (folder_ / "mixed/right_*.png").string())));
  folder_.write("empty/notes.txt", "");
  EXPECT_THAT(openError("empty"),
              AllOf(HasSubstr("notes.txt"), HasSubstr("PNG, JPEG or PGM"), Not(HasSubstr("ln -s"))));
}

TEST_F(Layouts, BagIsToldHowToBecomeImages) {
  folder_.write("one/drive.bag", "#ROSBAG V2.0\n");
  folder_.write("two/drive_0.db3", "SQLite");
  for (const char* name : {"one", "one/drive.bag"})
    EXPECT_THAT(openError(name), AllOf(HasSubstr("drive.bag: is a bag"), HasSubstr("mcap convert"),
                                       HasSubstr("rosbag info"), HasSubstr("read_messages")));
  for (const char* name : {"two", "two/drive_0.db3"})
    EXPECT_THAT(openError(name), AllOf(HasSubstr("motorcade run"), HasSubstr("drive_0.db3"), HasSubstr("ros2 bag info"),
                                       HasSubstr("sqlite3")));
  EXPECT_THAT(openError("nowhere"), HasSubstr("does not exist"));
}

}  // namespace
}  // namespace motorcade
