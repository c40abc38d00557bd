#include <cstdint>
#include <string>

#include <diagnostic_msgs.h>
#include <geometry_msgs.h>
#include <nav_msgs.h>
#include <tf2_msgs.h>
#include <visualization_msgs.h>

#include "tests/apps/bridge/wire_bytes.hpp"

/// Compares the bytes of each message with ROS 2's definitions, which are written down here by hand. A missing,
/// exchanged or wrongly typed field of apps/bridge/idl is thus found.
namespace motorcade::test {
namespace {

TEST_F(BridgeWire, PoseStamped) {
  const RawReader reader(domain_, geometry_msgs_msg_dds__PoseStamped__desc, "rt/motorcade/pose");
  publisher_.publish(ros::PoseStamped{.header = kWiredHeader, .pose = kWiredPose});
  EXPECT_EQ(reader.next(), startedWithHeader().doubles(kPoseNumbers).bytes());
}

TEST_F(BridgeWire, Odometry) {
  const RawReader reader(domain_, nav_msgs_msg_dds__Odometry__desc, "rt/motorcade/odometry");
  ros::Odometry message{.header = kWiredHeader, .child_frame_id = "base_link", .pose = kWiredPose};
  message.linear_mps = {10, 11, 12};
  message.angular_radps = {13, 14, 15};
  message.pose_covariance = countedFrom(100);
  message.twist_covariance = countedFrom(200);
  publisher_.publish(message);
  EXPECT_EQ(reader.next(), startedWithHeader()
                               .text("base_link")
                               .doubles(kPoseNumbers)
                               .counted(100)
                               .doubles({10, 11, 12, 13, 14, 15})
                               .counted(200)
                               .bytes());
}

TEST_F(BridgeWire, MarkerArray) {
  const RawReader reader(domain_, visualization_msgs_msg_dds__MarkerArray__desc, "rt/motorcade/objects");
  ros::Marker marker{
      .header = kWiredHeader, .ns = "velocity", .id = 7, .type = ros::Marker::Type::kArrow, .pose = kWiredPose};
  marker.scale = {4, 5, 6};
  marker.color = {.r = 0.1F, .g = 0.2F, .b = 0.3F, .a = 0.4F};
  marker.lifetime_ns = 1'500'000'000;
  marker.points = {{20, 21, 22}, {23, 24, 25}};
  marker.text = "7: 5.0 m/s";
  ros::Marker deleted;
  deleted.action = ros::Marker::Action::kDelete;
  publisher_.publish(ros::MarkerArray{.markers = {marker, deleted}});

  Cdr expected;
  expected.count(2).stamp(1'317'042'275, 123'456'789).text("odom").text("velocity");
  expected.add<std::int32_t>(7).add<std::int32_t>(0).add<std::int32_t>(0);  // id, type ARROW, action ADD
  expected.doubles(kPoseNumbers).doubles({4, 5, 6}).add(0.1F).add(0.2F).add(0.3F).add(0.4F).stamp(1, 500'000'000);
  expected.add<std::uint8_t>(0);                                      // frame_locked
  expected.count(2).doubles({20, 21, 22, 23, 24, 25}).count(0);       // points, colors
  expected.text("").stamp(0, 0).text("").text("").count(0).count(0);  // texture_resource, texture, uv_coordinates
  expected.text("7: 5.0 m/s").text("").text("").count(0).add<std::uint8_t>(0);  // text, mesh
  expected.stamp(0, 0).text("").text("").add<std::int32_t>(0).add<std::int32_t>(1).add<std::int32_t>(2);
  expected.doubles({0, 0, 0, 0, 0, 0, 1}).doubles({0, 0, 0}).add(0.0F).add(0.0F).add(0.0F).add(1.0F).stamp(0, 0);
  expected.add<std::uint8_t>(0).count(0).count(0);
  expected.text("").stamp(0, 0).text("").text("").count(0).count(0);
  expected.text("").text("").text("").count(0).add<std::uint8_t>(0);
  EXPECT_EQ(reader.next(), expected.bytes());
}

TEST_F(BridgeWire, TfMessage) {
  const RawReader reader(domain_, tf2_msgs_msg_dds__TFMessage__desc, "rt/tf");
  publisher_.publish(
      ros::TransformStamped{.header = kWiredHeader, .child_frame_id = "base_link", .transform = kWiredPose});
  Cdr expected;
  expected.count(1).stamp(1'317'042'275, 123'456'789).text("odom").text("base_link").doubles(kPoseNumbers);
  EXPECT_EQ(reader.next(), expected.bytes());
}

TEST_F(BridgeWire, DiagnosticArray) {
  const RawReader reader(domain_, diagnostic_msgs_msg_dds__DiagnosticArray__desc, "rt/diagnostics");
  ros::DiagnosticStatus status{.level = ros::DiagnosticStatus::Level::kError, .name = "motorcade: tracker"};
  status.message = "lost: dark";
  status.hardware_id = "0003";
  status.values = {{"cause", "no_points"}, {"segment", "2"}};
  publisher_.publish(ros::DiagnosticArray{.header = kWiredHeader, .status = {status, {}}});
  Cdr expected = startedWithHeader();
  expected.count(2).add<std::uint8_t>(2).text("motorcade: tracker").text("lost: dark").text("0003");
  expected.count(2).text("cause").text("no_points").text("segment").text("2");
  expected.add<std::uint8_t>(0).text("").text("").text("").count(0);
  EXPECT_EQ(reader.next(), expected.bytes());
}

}  // namespace
}  // namespace motorcade::test
