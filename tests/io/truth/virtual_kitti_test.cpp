#include "io/truth/virtual_kitti.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/images/mask_image.hpp"
#include "io/layouts/open_sequence.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/virtual_kitti_drive.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

/// Two frames of 1242x375 whose camera moves 1.5 m ahead, with a car 10 m ahead; tables as the data set has them, with
/// seven digits.
class VirtualKittiLayout : public testing::Test {
 protected:
  VirtualKittiLayout() { writeImages("Scene01/clone"); }

  void writeImages(const std::filesystem::path& variation, int first = 0) {
    Image image = ImagePool().acquire(1242, 375);
    for (int y = 0; y < 375; ++y) std::fill_n(image.mutableRow(y), 1242, static_cast<std::uint8_t>(90 + y % 60));
    for (const char* const camera : {"Camera_0", "Camera_1"})
      for (int i = first; i < first + 2; ++i)
        folder_.write(variation / "frames/rgb" / camera / ("rgb_0000" + std::to_string(i) + ".jpg"),
                      encodeJpeg(image, 80));
  }
  void writeTables(const std::filesystem::path& place, const std::string& right_x = "-0.532725", int first = 0) {
    std::ostringstream intrinsic, extrinsic;
    intrinsic << "frame cameraID K[0,0] K[1,1] K[0,2] K[1,2]\n";
    extrinsic << "frame cameraID r1,1 r1,2 r1,3 t1 r2,1 r2,2 r2,3 t2 r3,1 r3,2 r3,3 t3 0 0 0 1\n";
    for (int i = first; i < first + 2; ++i)
      for (const int camera : {0, 1}) {
        intrinsic << i << ' ' << camera << " 725.0087 725.0087 620.5 187\n";
        extrinsic << i << ' ' << camera << " 1 0 0 " << (camera == 0 ? "0" : right_x) << " 0 1 0 2 0 0 1 "
                  << 4 - 1.5 * (i - first) << " 0 0 0 1\n";
      }
    folder_.write(place / "intrinsic.txt", intrinsic.str());
    folder_.write(place / "extrinsic.txt", extrinsic.str());
    folder_.write(place / "info.txt",
                  "trackID label model color\n0 Van Renault_Kangoo White\n3 Car Sedan4Door Black\n");
  }
  void writeObjects(const std::filesystem::path& place, const std::string& pixels,
                    const std::string& truncation = "0") {
    folder_.write(place / "pose.txt", std::string(kPoseHead) +
                                          "0 0 3 -1.57 1.8 1.5 4 0 0 10 1.57 0 0 0 1.6 10 -1.570796 0 0\n"
                                          "0 1 3 -1.57 1.8 1.5 4 0 0 10 1.57 0 0 -0.53 1.6 10 -1.570796 0 0\n"
                                          "1 0 0 -1.57 1.8 1.5 4 0 0 10 1.57 0 0 0 1.6 12 -1.570796 0 0\n");
    folder_.write(place / "bbox.txt",
                  "frame cameraID trackID left right top bottom number_pixels truncation_ratio occupancy_ratio "
                  "isMoving\n0 0 3 540 700 190 330 " +
                      pixels + " " + truncation + " 0.7 True\n0 1 3 500 660 190 330 " + pixels + " 0 0.7 True\n");
  }
  Sequence open() { return openSequence(folder_ / "Scene01" / "clone"); }
  ObjectTruths objects() {
    const Sequence sequence = open();
    return readObjectTruths(sequence, *readCameraTruth(sequence)).value();
  }
  std::string openError(const std::filesystem::path& name) {
    return messageOf<InputError>([&] { openSequence(folder_ / name); });
  }

  static constexpr const char* kPoseHead =
      "frame cameraID trackID alpha width height length world_space_X world_space_Y world_space_Z "
      "rotation_world_space_y rotation_world_space_x rotation_world_space_z camera_space_X camera_space_Y "
      "camera_space_Z rotation_camera_space_y rotation_camera_space_x rotation_camera_space_z\n";
  test::TemporaryFolder folder_;
};

TEST_F(VirtualKittiLayout, CameraAndPathAreThoseOfTheTables) {
  writeTables("Scene01/clone");
  const Sequence sequence = open();
  EXPECT_EQ(sequence.layout, "virtual_kitti");
  ASSERT_EQ(sequence.frames.size(), 2U);
  EXPECT_EQ(sequence.frames[1].right.filename(), "rgb_00001.jpg");
  EXPECT_EQ(sequence.camera.fx_px, 725.0087);
  EXPECT_EQ(sequence.camera.baseline_m, 0.532725);
  EXPECT_EQ(sequence.stamps[1].ns, 100'000'000);
  EXPECT_TRUE(sequence.truth.exact());
  const auto truth = readCameraTruth(sequence);
  ASSERT_TRUE(truth);
  EXPECT_NEAR(truth->T_world_cam[0].log().norm(), 0, 1e-12);
  EXPECT_NEAR((truth->T_world_cam[1].translation() - Eigen::Vector3d(0, 0, 1.5)).norm(), 0, 1e-12);
}

TEST_F(VirtualKittiLayout, TheStatedBaselineCountsWhereRoundedExtrinsicsAgree) {
  writeTables("Scene01/clone", "-0.5327");
  EXPECT_EQ(open().camera.baseline_m, 0.532725);
  writeTables("Scene01/clone", "-0.54");
  EXPECT_NEAR(open().camera.baseline_m, 0.54, 1e-12);
  writeTables("Scene01/clone", "0.54");
  EXPECT_THAT(openError("Scene01/clone"), AllOf(HasSubstr("extrinsic.txt"), HasSubstr("not to the right")));
}

TEST_F(VirtualKittiLayout, ObjectsHaveTypePoseAndBox) {
  writeTables("Scene01/clone");
  writeObjects("Scene01/clone", "16000");
  const auto truths = objects();
  ASSERT_EQ(truths.objects.size(), 2U);  // those of the left camera
  const ObjectTruth& car = truths.objects[0];
  EXPECT_EQ(car.id, 3);
  EXPECT_EQ(car.type, "Car");
  EXPECT_EQ(car.size_m, Eigen::Vector3d(1.5, 1.8, 4));  // height, width, length
  EXPECT_EQ(car.box.right_px, 700);
  EXPECT_EQ(car.box.bottom_px, 330);
  // Its length lies along the camera's axis: heading away.
  EXPECT_NEAR((car.T_cam_object * Eigen::Vector3d(2, 0, 0) - Eigen::Vector3d(0, 1.6, 12)).norm(), 0, 1e-5);
  const ObjectTruth& van = truths.objects[1];
  EXPECT_EQ(van.type, "Van");
  EXPECT_NEAR(van.T_world_object.translation().z(), 13.5, 1e-9);
  EXPECT_EQ(van.occluded, 2);  // it has no pixel
}

TEST_F(VirtualKittiLayout, OcclusionFollowsTheShareOfThePixelsThatCanBeSeen) {
  writeTables("Scene01/clone");
  // A cuboid 1.8 m wide and 1.5 m high whose near face is 8 m ahead covers about 163 x 136 px.
  const auto occlusion = [&](const std::string& pixels) {
    writeObjects("Scene01/clone", pixels);
    return objects().objects[0].occluded;
  };
  EXPECT_EQ(occlusion("18000"), 0);
  EXPECT_EQ(occlusion("10500"), 1);
  EXPECT_EQ(occlusion("4000"), 2);
  EXPECT_EQ(occlusion("0"), 2);
  // Half of it is outside of the image: what fills most of the box of 160 x 140 px is not hidden.
  writeObjects("Scene01/clone", "14000", "0.5");
  EXPECT_EQ(objects().objects[0].occluded, 0);
  writeObjects("Scene01/clone", "4000", "0.5");
  EXPECT_EQ(objects().objects[0].occluded, 2);
}

TEST_F(VirtualKittiLayout, AnglesTurnAboutZThenXThenY) {
  writeTables("Scene01/clone");
  // A row of the data set: its alpha is rotation_y less the direction in which the camera sees the object.
  folder_.write("Scene01/clone/pose.txt",
                std::string(kPoseHead) +
                    "1 0 0 1.69414 1.776562 1.421875 3.617188 53.18796 -106 79.85496 2.263542 0 0 -3.088518 1.056862 "
                    "55.55215 1.638601 -0.01539355 0.03731001\n");
  folder_.write("Scene01/clone/bbox.txt",
                "frame cameraID trackID left right top bottom number_pixels truncation_ratio occupancy_ratio "
                "isMoving\n");
  const Eigen::Matrix3d R = objects().objects.at(0).T_cam_object.rotation();
  EXPECT_THAT(test::anglesYxz(R), test::IsNear(Eigen::Vector3d(1.638601, -0.01539355, 0.03731001), 1e-9));
  EXPECT_NEAR(1.638601 - std::atan2(-3.088518, 55.55215), 1.69414, 1e-4);
  // The object stands upright in the world, so that its down axis is the world's: the camera looks 2 degrees down, and
  // does not roll by more than 1.
  const Eigen::Vector3d down = R.col(1);
  EXPECT_NEAR(std::atan2(down.z(), down.y()), 0.038, 0.002);
  EXPECT_NEAR(down.x(), -0.013, 0.002);
}

TEST_F(VirtualKittiLayout, ArchivesMayBeUnpackedBesideEachOther) {
  for (const std::string around : {"", "all/"}) {
    const std::string root = around + "vkitti_2.0.3_rgb/Scene02/fog";
    writeImages(root);
    writeTables(around + "vkitti_2.0.3_textgt/Scene02/fog");
    test::fs::create_directories(folder_ / (around + "vkitti_2.0.3_instanceSegmentation/Scene02/fog") /
                                 "frames/instanceSegmentation/Camera_0");
    const Sequence sequence = openSequence(folder_ / root);
    EXPECT_EQ(sequence.truth.virtual_kitti, folder_ / (around + "vkitti_2.0.3_textgt/Scene02/fog"));
    EXPECT_THAT(sequence.truth.instances.string(), HasSubstr("vkitti_2.0.3_instanceSegmentation/Scene02/fog/frames"));
  }
}

TEST_F(VirtualKittiLayout, FramesGoByTheirNumbers) {
  test::fs::remove_all(folder_ / "Scene01");
  writeImages("Scene01/clone", 5);
  writeTables("Scene01/clone", "-0.532725", 5);
  test::fs::create_directories(folder_ / "Scene01/clone/frames/instanceSegmentation/Camera_0");
  const Sequence sequence = open();
  EXPECT_NEAR(readCameraTruth(sequence)->T_world_cam[1].translation().z(), 1.5, 1e-12);
  EXPECT_TRUE(sequence.truth.instances.empty());  // its masks are found by the frames' own numbers
  writeTables("Scene01/clone", "-0.532725", 6);
  EXPECT_THAT(messageOf<InputError>([&] { readCameraTruth(open()); }),
              AllOf(HasSubstr("extrinsic.txt"), HasSubstr("no line of frame 5")));
}

TEST_F(VirtualKittiLayout, ASceneOrTheRootNamesItsVariations) {
  writeImages("Scene01/30-deg-left");
  EXPECT_THAT(openError("Scene01"), AllOf(HasSubstr("30-deg-left, clone"), HasSubstr("virtual_kitti_2.toml")));
  EXPECT_THAT(openError("."), AllOf(HasSubstr("Scene01/30-deg-left, Scene01/clone")));
  EXPECT_THAT(openError("Scene01/clone"), AllOf(HasSubstr("intrinsic.txt: is missing"), HasSubstr("textgt.tar.gz"),
                                                HasSubstr("--camera 725.0087")));
  EXPECT_EQ(openSequence(folder_ / "Scene01" / "clone", 10, {.camera = "725.0087,725.0087,620.5,187,0.532725"}).layout,
            "virtual_kitti");
}

TEST_F(VirtualKittiLayout, MistakesInTheTablesAreNamed) {
  writeTables("Scene01/clone");
  folder_.write("Scene01/clone/intrinsic.txt", "0 0 725 725 620 187\n");
  EXPECT_THAT(openError("Scene01/clone"), AllOf(HasSubstr("intrinsic.txt"), HasSubstr("first line must begin with")));
  folder_.write("Scene01/clone/intrinsic.txt", "frame\n0 0 725 725 620 187\n0 1 700 725 620 187\n");
  EXPECT_THAT(openError("Scene01/clone"), AllOf(HasSubstr("intrinsic.txt"), HasSubstr("line 3")));
  writeTables("Scene01/clone");
  writeObjects("Scene01/clone", "many");
  EXPECT_THAT(messageOf<InputError>([&] { objects(); }), AllOf(HasSubstr("bbox.txt"), HasSubstr("line 2")));
}

TEST(ReadInstances, GivesTheIndicesOfAPalette) {
  const test::TemporaryFolder folder;
  std::vector<std::uint8_t> indices(40 * 30);
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint8_t>(i % 251);
  test::writeIndexedPng(folder / "instancegt_00007.png", 40, 30, indices);
  EXPECT_EQ(instanceFile(folder.path(), FrameId{7}), folder / "instancegt_00007.png");
  const Gray16Image image = readInstances(instanceFile(folder.path(), FrameId{7}));
  EXPECT_EQ(image.width, 40);
  EXPECT_TRUE(std::equal(indices.begin(), indices.end(), image.pixels.begin(), image.pixels.end()));
  std::filesystem::resize_file(folder / "instancegt_00007.png", 900);
  EXPECT_THAT(messageOf<InputError>([&] { readInstances(folder / "instancegt_00007.png"); }),
              HasSubstr("instancegt_00007.png"));
  EXPECT_EQ(instanceFile(folder.path(), FrameId{8}), folder / "000008.png");
}

}  // namespace
}  // namespace motorcade
