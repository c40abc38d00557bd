#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "apps/evaluate/report/report.hpp"
#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/truth/ground_truth.hpp"
#include "io/truth/trajectory.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using testing::HasSubstr;

constexpr double kHalfTurn_rad = std::numbers::pi;

/// Body axes in the camera's, for a car that heads `heading_rad` to the left of where the camera looks.
Eigen::Matrix3d camBody(double heading_rad) {
  Eigen::Matrix3d cam_body;
  const double c = std::cos(heading_rad), s = std::sin(heading_rad);
  cam_body << -s, -c, 0, 0, 0, -1, c, -s, 0;
  return cam_body;
}

ObjectEstimate carAt(const SE3& T_world_body) {
  ObjectEstimate object;
  object.track = {7};
  object.T_world_body = T_world_body;
  object.points = 12;
  object.box = {-20, 100, 300, 200};
  object.cuboid = ObjectBox{};
  object.cuboid->size_m = {4, 1.75, 1.5};
  object.cuboid->kind = ObjectKind::kCar;
  object.existence_probability = 0.75;
  return object;
}

Sequence sequenceNamed(const std::string& name) {
  Sequence sequence;
  sequence.folder = std::filesystem::path("drives") / name;
  sequence.camera = {.fx_px = 700, .fy_px = 700, .cx_px = 600, .cy_px = 180, .baseline_m = 0.5};
  sequence.camera.width_px = 1242;
  sequence.camera.height_px = 375;
  return sequence;
}

TEST(KittiExport, APlacedCarHasTheLineThatKittiDefines) {
  const test::TemporaryFolder folder;
  RunFolder run{.first_frame = 5};
  run.final.camera = {SE3()};
  ObjectEstimate car = carAt(SE3(camBody(0), {10, 1, 10}));  // it heads where the camera looks
  car.cuboid->center_body = {1, 0.5, 0.25};
  run.final.objects.push_back({.frame = {5}, .object = car});
  exportKitti(folder.path(), run, sequenceNamed("0003"));
  // The middle lies 1 m ahead of the origin (z), 0.5 m to its left (-x), 0.25 m above (-y); the bottom 0.75 m lower.
  // rotation_y is -pi/2 for what heads along z; the camera sees it under atan2(9.5, 11). Twelve points: 2/3 of .75.
  EXPECT_EQ(folder.read("final/data/0003.txt"),
            "5 7 Car -1 -1 -2.283154 0.000000 100.000000 300.000000 200.000000 1.500000 1.750000 4.000000 "
            "9.500000 1.500000 11.000000 -1.570796 0.500000\n");
  EXPECT_EQ(folder.read("online/data/0003.txt"), "");
}

TEST(KittiExport, HeadingsTurnFromTheCamerasRightTowardsItself) {
  const test::TemporaryFolder folder;
  RunFolder run;
  run.online.camera = {SE3()};
  for (int quarter = 0; quarter < 4; ++quarter)
    run.online.objects.push_back(
        {.frame = {0}, .object = carAt(SE3(camBody(quarter * kHalfTurn_rad / 2), {0, 1, 20}))});
  exportKitti(folder.path(), run, sequenceNamed("0003"));
  const auto labels = readLabels(folder / "online/data/0003.txt");
  ASSERT_EQ(labels.size(), 4U);
  // Ahead, left, towards the camera, right, as KITTI's rotation_y about the axis that points down.
  const double expected[] = {-kHalfTurn_rad / 2, kHalfTurn_rad, kHalfTurn_rad / 2, 0};
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(std::remainder(labels[i].rotation_y_rad - expected[i], 2 * kHalfTurn_rad), 0, 1e-6) << i;
}

TEST(KittiExport, LeavesOutWhatWasNotSeenOrHasNoCuboid) {
  const test::TemporaryFolder folder;
  RunFolder run;
  run.final.camera = {SE3()};
  const ObjectEstimate car = carAt(SE3(camBody(0), {0, 1, 20}));
  ObjectEstimate predicted = car, sparse = car, shapeless = car, kindless = car;
  predicted.state = ObjectState::kPredicted;
  sparse.points = 2;
  shapeless.cuboid.reset();
  kindless.cuboid->kind = ObjectKind::kUnknown;
  for (const auto& object : {predicted, sparse, shapeless, kindless})
    run.final.objects.push_back({.frame = {0}, .object = object});
  run.final.objects.push_back({.frame = {1}, .object = car});  // whose camera pose a kill has cut off
  exportKitti(folder.path(), run, sequenceNamed("drive"));
  const auto labels = readLabels(folder / "final/data/drive.txt");
  ASSERT_EQ(labels.size(), 1U);
  EXPECT_EQ(labels[0].type, "Misc");
}

/// A drive of four frames on a curve, with the color pair, and labels of three kinds.
class LabeledDrive : public testing::Test {
 protected:
  LabeledDrive() {
    ImagePool pool;
    Image image = pool.acquire(320, 96);
    for (int y = 0; y < 96; ++y) std::fill_n(image.mutableRow(y), 320, std::uint8_t{90});
    for (int i = 0; i < 4; ++i)
      for (const char* side : {"drive/image_02", "drive/image_03"}) {
        std::filesystem::create_directories(folder_ / side);
        writePng(folder_ / side / (std::to_string(i) + ".png"), image);
      }
    folder_.write("drive/calib.txt",
                  "P0: 300 0 160 0 0 300 48 0 0 0 1 0\nP1: 300 0 160 -150 0 300 48 0 0 0 1 0\n"
                  "P2: 300 0 160 18 0 300 48 -0.3 0 0 1 0.005\nP3: 300 0 160 -132 0 300 48 -0.3 0 0 1 0.005\n");
    std::string poses;
    for (int i = 0; i < 4; ++i) poses += kittiLine(SE3::exp((Vector6d() << 0, 0, i, 0, 0.02 * i, 0).finished())) + "\n";
    folder_.write("drive/poses.txt", poses);
    folder_.write("drive/label_02.txt",
                  "0 1 Car 0 0 0 10 10 40 60 1.5 1.7 4.2 -3 1.6 12 -1.57\n"
                  "1 2 Cyclist 0 0 0 50 12 60 44 1.75 0.5 1.8 4 1.5 9 0.4\n"
                  "2 1 Car 0 0 0 11 10 41 60 1.5 1.7 4.2 -3.2 1.6 13 3.0\n"
                  "3 3 Pedestrian 0 0 0 70 12 75 44 1.8 0.6 0.8 1 1.5 6 -2.5\n");
  }

  /// A run whose objects are the labels, with body frames anywhere in them.
  RunFolder runOfLabels(const Sequence& sequence) const {
    const auto camera = readCameraTruth(sequence);
    const auto truths = readObjectTruths(sequence, *camera);
    Eigen::Matrix3d box_body;  // a box frame has y down and z left
    box_body << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    RunFolder run;
    run.final.camera = camera->T_world_cam;
    for (const auto& truth : truths->objects) {
      const Eigen::Vector3d bottom_body(0.5, -0.25, -0.4);
      ObjectEstimate object;
      object.track = {truth.id};
      object.points = 5;
      object.box = truth.box;
      object.T_world_body = truth.T_world_object * SE3(box_body, -(box_body * bottom_body));
      object.cuboid = ObjectBox{};
      object.cuboid->size_m = truth.size_m.reverse();
      object.cuboid->center_body = bottom_body + Eigen::Vector3d(0, 0, 0.5 * truth.size_m.x());
      object.cuboid->kind = truth.type == "Car"       ? ObjectKind::kCar
                            : truth.type == "Cyclist" ? ObjectKind::kTwoWheeler
                                                      : ObjectKind::kPedestrian;
      run.final.objects.push_back({.frame = truth.frame, .object = object});
    }
    return run;
  }

  test::TemporaryFolder folder_;
};

TEST_F(LabeledDrive, AnExportedRunOfTheLabelsGivesTheLabelsBack) {
  const Sequence sequence = openSequence(folder_ / "drive");
  ASSERT_EQ(sequence.pair, CameraPair::kColor);
  exportKitti(folder_ / "results", runOfLabels(sequence), sequence);
  const auto labels = readLabels(folder_ / "drive/label_02.txt"),
             exported = readLabels(folder_ / "results/final/data/drive.txt");
  ASSERT_EQ(exported.size(), labels.size());
  constexpr double kPrinted = 1e-6;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    EXPECT_EQ(exported[i].frame, labels[i].frame);
    EXPECT_EQ(exported[i].track, labels[i].track);
    EXPECT_EQ(exported[i].type, labels[i].type);
    EXPECT_THAT(exported[i].size_m, IsNear(labels[i].size_m, kPrinted));
    EXPECT_THAT(exported[i].location_m, IsNear(labels[i].location_m, kPrinted)) << i;
    EXPECT_NEAR(exported[i].rotation_y_rad, labels[i].rotation_y_rad, kPrinted) << i;
    EXPECT_DOUBLE_EQ(exported[i].box.right_px, labels[i].box.right_px);
  }
}

TEST_F(LabeledDrive, NeedsNoGroundTruth) {
  std::filesystem::remove(folder_ / "drive/poses.txt");
  std::filesystem::remove(folder_ / "drive/label_02.txt");
  folder_.write("run/camera_online.txt", kittiLine(SE3()) + "\n");
  EvaluateOptions options;
  options.run = folder_ / "run";
  options.sequence = folder_ / "drive";
  options.export_kitti = folder_ / "results";
  testing::internal::CaptureStdout();
  EXPECT_EQ(runEvaluate(options), 0);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("no ground truth"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "results/online/data/drive.txt"));
  options.json = folder_ / "measures.json";
  EXPECT_THROW(runEvaluate(options), InputError) << "measures were asked for";
  options.export_kitti = folder_ / "run/camera_online.txt";
  EXPECT_THROW(runEvaluate(options), OutputError);
}

}  // namespace
}  // namespace motorcade
