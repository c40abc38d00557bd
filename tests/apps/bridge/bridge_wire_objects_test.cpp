#include <cstdint>

#include <autoware_perception_msgs.h>
#include <vision_msgs.h>

#include "tests/apps/bridge/wire_bytes.hpp"

/// Compares the bytes of messages about objects with the definitions of autoware_perception_msgs and vision_msgs.
namespace motorcade::test {
namespace {

using Label = ros::ObjectClassification::Label;

ros::TrackedObject trackedCar() {
  ros::TrackedObject object{.existence_probability = 0.75F,
                            .classification = {{Label::kCar, 0.5F}, {Label::kUnknown, 0.25F}}};
  for (std::uint8_t i = 0; i < 16; ++i) object.object_id[i] = static_cast<std::uint8_t>(0xF0 + i);
  object.pose = kWiredPose;
  object.pose_covariance = countedFrom(100);
  object.linear_mps = {10, 11, 12};
  object.angular_radps = {13, 14, 15};
  object.twist_covariance = countedFrom(200);
  object.linear_mps2 = {16, 17, 18};
  object.angular_radps2 = {19, 20, 21};
  object.acceleration_covariance = countedFrom(300);
  object.orientation = ros::TrackedObject::Orientation::kAvailable;
  object.is_stationary = true;
  object.dimensions_m = {4, 1.8, 1.5};
  return object;
}

TEST_F(BridgeWire, TrackedObjects) {
  const RawReader reader(domain_, autoware_perception_msgs_msg_dds__TrackedObjects__desc,
                         "rt/motorcade/tracked_objects");
  publisher_.publish(ros::TrackedObjects{.header = kWiredHeader, .objects = {trackedCar(), {}}});
  Cdr expected = startedWithHeader();
  expected.count(2);
  for (int i = 0; i < 16; ++i) expected.add(static_cast<std::uint8_t>(0xF0 + i));  // object_id
  expected.add(0.75F).count(2).add<std::uint8_t>(1).add(0.5F).add<std::uint8_t>(0).add(0.25F);
  expected.doubles(kPoseNumbers).counted(100);
  expected.doubles({10, 11, 12, 13, 14, 15}).counted(200).doubles({16, 17, 18, 19, 20, 21}).counted(300);
  expected.add<std::uint8_t>(2).add<std::uint8_t>(1);             // orientation_availability, is_stationary
  expected.add<std::uint8_t>(0).count(0).doubles({4, 1.8, 1.5});  // shape: type, footprint, dimensions
  for (int i = 0; i < 16; ++i) expected.add<std::uint8_t>(0);
  expected.add(0.0F).count(0).doubles({0, 0, 0, 0, 0, 0, 1});
  for (int i = 0; i < 3; ++i) expected.doubles(std::vector<double>(i == 0 ? 36 : 42, 0));
  expected.add<std::uint8_t>(0).add<std::uint8_t>(0).add<std::uint8_t>(0).count(0).doubles({0, 0, 0});
  EXPECT_EQ(reader.next(), expected.bytes());
}

TEST_F(BridgeWire, Detection3DArray) {
  const RawReader reader(domain_, vision_msgs_msg_dds__Detection3DArray__desc, "rt/motorcade/detections");
  ros::Detection3D detection{.box_center = {.position = {4, 5, 6}, .orientation = {0.4, 0.5, 0.6, 0.7}}};
  detection.results = {{.class_id = "car", .score = 0.5, .pose = kWiredPose, .covariance = countedFrom(100)},
                       {.class_id = "unknown", .score = 0.25, .pose = kWiredPose, .covariance = countedFrom(200)}};
  detection.box_size_m = {7, 8, 9};
  detection.id = "0125d8e3";
  publisher_.publish(ros::Detection3DArray{.header = kWiredHeader, .detections = {detection, {}}});
  Cdr expected = startedWithHeader();
  expected.count(2).stamp(1'317'042'275, 123'456'789).text("odom").count(2);
  expected.text("car").add(0.5).doubles(kPoseNumbers).counted(100);
  expected.text("unknown").add(0.25).doubles(kPoseNumbers).counted(200);
  expected.doubles({4, 5, 6, 0.4, 0.5, 0.6, 0.7}).doubles({7, 8, 9}).text("0125d8e3");
  expected.stamp(1'317'042'275, 123'456'789).text("odom").count(0);
  expected.doubles({0, 0, 0, 0, 0, 0, 1}).doubles({0, 0, 0}).text("");
  EXPECT_EQ(reader.next(), expected.bytes());
}

}  // namespace
}  // namespace motorcade::test
