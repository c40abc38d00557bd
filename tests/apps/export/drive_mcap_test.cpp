#include "apps/export/drive_mcap.hpp"

#include <algorithm>
#include <map>
#include <string>

#include <Eigen/Geometry>
#include <foxglove/CompressedImage.pb.h>
#include <foxglove/FrameTransforms.pb.h>
#include <foxglove/PointCloud.pb.h>
#include <foxglove/PosesInFrame.pb.h>
#include <foxglove/SceneUpdate.pb.h>
#include <gmock/gmock.h>
#include <google/protobuf/descriptor.pb.h>
#include <motorcade/FrameDiagnostics.pb.h>

#include "tests/apps/export/mcap_reading.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::McapContent;

/// A car that drives where the camera looks, 4 x 2 x 1.5 m, and a camera that follows it.
ExportedFrame frameAt(int index, bool with_car) {
  Eigen::Matrix3d world_body;
  world_body << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  ExportedFrame frame;
  frame.estimate.head.frame = {index};
  frame.estimate.head.stamp = {std::int64_t{100'000'000} * index + 7};
  frame.estimate.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {0, 0, 1.0 * index});
  frame.jpeg = "image " + std::to_string(index);
  frame.points = {{{}, {1, 2, 3}}};
  if (!with_car) return frame;
  ObjectEstimate car;
  car.track = {4};
  car.T_world_body = SE3(world_body, {0, 0.75, 12.0 + index});
  car.velocity_world_mps = {0, 0, 10};
  car.speed_sigma_mps = 0.25;
  car.existence_probability = 0.875;
  if (index > 4) car.acceleration = {.along_mps2 = -2.5, .along_sigma_mps2 = 0.5};
  car.cuboid = ObjectBox{.center_body = {1, 0.5, 0.25}, .size_m = {4, 2, 1.5}};
  frame.estimate.objects = {car};
  frame.points.push_back({{4}, {-1, 0.5, 12}});
  return frame;
}

template <class Message>
Message parsed(const McapContent::Message& message) {
  Message parsed;
  EXPECT_TRUE(parsed.ParseFromString(message.data));
  return parsed;
}

/// Twelve frames; the car is there in frames 2 to 8.
class DriveMcapFile : public testing::Test {
 protected:
  DriveMcapFile() {
    DriveMcap out(folder_ / "drive.mcap", {700, 710, 600, 180, 0.5, 1242, 375});
    for (int i = 0; i < 12; ++i) out.write(frameAt(i, i >= 2 && i <= 8));
    out.close();
    content_ = test::readMcap(folder_.read("drive.mcap"));
  }
  const std::vector<McapContent::Message>& of(const char* topic) { return content_.messages.at(topic); }

  test::TemporaryFolder folder_;
  McapContent content_;
};

TEST_F(DriveMcapFile, HasEveryTopicInEveryFrameAndThePathOnceASecond) {
  for (const char* topic : {"/camera/left/compressed", "/camera/calibration", "/tf", "/camera/pose", "/objects",
                            "/points", "/diagnostics"}) {
    ASSERT_EQ(of(topic).size(), 12U) << topic;
    for (std::uint64_t i = 0; i < 12; ++i) EXPECT_EQ(of(topic)[i].log_ns, 100'000'000 * i + 7) << topic;
  }
  ASSERT_EQ(of("/camera/path").size(), 2U);
  EXPECT_EQ(parsed<foxglove::PosesInFrame>(of("/camera/path")[1]).poses_size(), 11);
}

TEST_F(DriveMcapFile, ItsSchemasDescribeTheirMessagesAlone) {
  for (const auto& [topic, id] : content_.schema_of) {
    const McapContent::Schema& schema = content_.schemas.at(id);
    google::protobuf::FileDescriptorSet files;
    ASSERT_TRUE(files.ParseFromString(schema.descriptors));
    google::protobuf::DescriptorPool pool;  // of its own: nothing that the program knows helps
    for (const auto& file : files.file()) ASSERT_NE(pool.BuildFile(file), nullptr) << file.name();
    EXPECT_NE(pool.FindMessageTypeByName(schema.name), nullptr) << topic;
  }
}

TEST_F(DriveMcapFile, ACuboidHasTheObjectsPoseSizeAndLabel) {
  const auto update = parsed<foxglove::SceneUpdate>(of("/objects")[5]);
  ASSERT_EQ(update.entities_size(), 1);
  const foxglove::SceneEntity& entity = update.entities(0);
  EXPECT_EQ(entity.id(), "object_4");
  EXPECT_EQ(entity.frame_id(), "world");
  ASSERT_EQ(entity.cubes_size(), 1);
  const auto& position = entity.cubes(0).pose().position();
  EXPECT_NEAR(position.x(), -0.5, 1e-9) << "half a meter to the body's left";
  EXPECT_NEAR(position.y(), 0.5, 1e-9);
  EXPECT_NEAR(position.z(), 12 + 5 + 1, 1e-9);
  EXPECT_EQ(entity.cubes(0).size().x(), 4);
  EXPECT_EQ(entity.texts(0).text(), "4: 10.0 +/- 0.2 m/s");
  EXPECT_LT(entity.texts(0).pose().position().y(), position.y() - 0.75) << "above it: y points down";
  EXPECT_EQ(entity.lines(0).points_size(), 4) << "frames 2 to 5";
}

TEST_F(DriveMcapFile, AnObjectsMetadataTellHowLikelyItIsThere) {
  const auto update = parsed<foxglove::SceneUpdate>(of("/objects")[5]);
  const auto& facts = update.entities(0).metadata();
  const auto fact = std::ranges::find(facts, "existence_probability", &foxglove::KeyValuePair::key);
  ASSERT_NE(fact, facts.end());
  EXPECT_EQ(fact->value(), "0.875");
}

TEST_F(DriveMcapFile, AnObjectsMetadataTellItsAccelerationOnceItIsKnown) {
  const auto of_frame = [&](std::size_t i) {
    const auto update = parsed<foxglove::SceneUpdate>(of("/objects")[i]);
    std::map<std::string, std::string> facts;
    for (const auto& fact : update.entities(0).metadata()) facts[fact.key()] = fact.value();
    return facts;
  };
  EXPECT_FALSE(of_frame(4).contains("acceleration_mps2"));
  EXPECT_EQ(of_frame(5)["acceleration_mps2"], "-2.5000");
  EXPECT_EQ(of_frame(5)["acceleration_sigma_mps2"], "0.5000");
}

TEST_F(DriveMcapFile, AnObjectThatIsGoneIsDeletedOnce) {
  int deletions = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    const auto update = parsed<foxglove::SceneUpdate>(of("/objects")[i]);
    deletions += update.deletions_size();
    if (i != 9) continue;
    ASSERT_EQ(update.deletions_size(), 1);
    EXPECT_EQ(update.deletions(0).id(), "object_4");
  }
  EXPECT_EQ(deletions, 1);
}

TEST_F(DriveMcapFile, PointsTellTheirTrack) {
  const auto cloud = parsed<foxglove::PointCloud>(of("/points")[3]);
  EXPECT_EQ(cloud.frame_id(), "camera");
  ASSERT_EQ(cloud.data().size(), 2 * cloud.point_stride());
  for (std::size_t point = 0; point < 2; ++point) {
    test::McapFields fields(std::string_view(cloud.data()).substr(point * cloud.point_stride()));
    EXPECT_EQ(fields.number<float>(), point == 0 ? 1 : -1);
    fields.number<float>();
    EXPECT_EQ(fields.number<float>(), point == 0 ? 3 : 12);
    EXPECT_EQ(fields.number<std::int32_t>(), point == 0 ? -1 : 4);
  }
}

TEST_F(DriveMcapFile, TheMapStandsUpright) {
  const auto transforms = parsed<foxglove::FrameTransforms>(of("/tf")[5]);
  ASSERT_EQ(transforms.transforms_size(), 3) << "map to world, world to camera, world to the object";
  const auto& q = transforms.transforms(0).rotation();
  const Eigen::Quaterniond map_world(q.w(), q.x(), q.y(), q.z());
  EXPECT_LT((map_world * Eigen::Vector3d(0, -1, 0) - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12) << "the camera's up";
  EXPECT_LT((map_world * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12) << "its ahead";
  EXPECT_EQ(transforms.transforms(1).child_frame_id(), "camera");
  EXPECT_NEAR(transforms.transforms(1).translation().z(), 5, 1e-12);
  EXPECT_EQ(transforms.transforms(2).child_frame_id(), "object_4");
}

TEST_F(DriveMcapFile, AFrameWithoutImageHasAllElse) {
  DriveMcap out(folder_ / "blind.mcap", {700, 710, 600, 180, 0.5, 1242, 375});
  ExportedFrame frame = frameAt(0, true);
  frame.jpeg.clear();
  out.write(frame);
  out.close();
  const McapContent content = test::readMcap(folder_.read("blind.mcap"));
  EXPECT_FALSE(content.messages.contains("/camera/left/compressed"));
  EXPECT_EQ(parsed<FrameDiagnostics>(content.messages.at("/diagnostics").at(0)).points_on_objects(), 1);
}

}  // namespace
}  // namespace motorcade
