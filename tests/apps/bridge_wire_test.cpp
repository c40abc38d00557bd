#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <geometry_msgs.h>
#include <gmock/gmock.h>
#include <nav_msgs.h>
#include <unistd.h>
#include <visualization_msgs.h>

#include "apps/bridge/dds_publisher.hpp"

/// The bytes of each message against ROS 2's definitions, written down here by hand, so that a field of apps/bridge/idl
/// that is missing, exchanged or of another type is found.
namespace motorcade::test {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

static_assert(std::endian::native == std::endian::little);

/// Plain CDR, little-endian (XCDR1, as ROS 2 sends): each value aligned to its size, counted from behind the header.
class Cdr {
 public:
  template <class Value>
  Cdr& add(Value value) {
    while ((bytes_.size() - kHeader.size()) % sizeof(Value) != 0) bytes_.push_back(0);
    for (const std::uint8_t byte : std::bit_cast<std::array<std::uint8_t, sizeof(Value)>>(value))
      bytes_.push_back(byte);
    return *this;
  }
  Cdr& text(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    for (const char character : text) bytes_.push_back(static_cast<std::uint8_t>(character));
    bytes_.push_back(0);
    return *this;
  }
  Cdr& stamp(std::int32_t sec, std::uint32_t nanosec) { return add(sec).add(nanosec); }
  Cdr& doubles(const std::vector<double>& values) {
    for (const double value : values) add(value);
    return *this;
  }
  Cdr& count(std::uint32_t count) { return add(count); }
  /// Padded to four bytes, as payloads of RTPS are; the header's last two bits tell by how much.
  Bytes bytes() const {
    Bytes padded = bytes_;
    while (padded.size() % 4 != 0) padded.push_back(0);
    padded[3] = static_cast<std::uint8_t>(padded.size() - bytes_.size());
    return padded;
  }

 private:
  static constexpr std::array<std::uint8_t, 4> kHeader{0, 1, 0, 0};
  Bytes bytes_{kHeader.begin(), kHeader.end()};
};

/// The bytes of the next message of a topic, as they are on the wire.
class RawReader {
 public:
  RawReader(int domain, const dds_topic_descriptor_t& type, const char* topic)
      : participant_(dds_create_participant(static_cast<dds_domainid_t>(domain), nullptr, nullptr)) {
    dds_qos_t* const qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    const dds_entity_t entity = dds_create_topic(participant_, &type, topic, nullptr, nullptr);
    reader_ = dds_create_reader(participant_, entity, qos, nullptr);
    dds_delete_qos(qos);
  }
  ~RawReader() { dds_delete(participant_); }
  RawReader(const RawReader&) = delete;
  RawReader& operator=(const RawReader&) = delete;

  std::vector<std::uint8_t> next() const {
    const auto deadline = std::chrono::steady_clock::now() + 10s;
    ddsi_serdata* data = nullptr;
    dds_sample_info_t info{};
    while (dds_takecdr(reader_, &data, 1, &info, DDS_ANY_STATE) <= 0) {
      if (std::chrono::steady_clock::now() > deadline) return {};
      std::this_thread::sleep_for(5ms);
    }
    std::vector<std::uint8_t> bytes(ddsi_serdata_size(data));
    ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
    ddsi_serdata_unref(data);
    return bytes;
  }

 private:
  dds_entity_t participant_, reader_ = 0;
};

class BridgeWire : public testing::Test {
 protected:
  const int domain_ = 60 + ::getpid() % 40;
  DdsPublisher publisher_{{.domain = domain_}};
};

const ros::Header kHeader{.stamp = {1'317'042'275, 123'456'789}, .frame_id = "odom"};
const ros::Pose kPose{.position = {1, 2, 3}, .orientation = {0.1, 0.2, 0.3, 0.9}};
const std::vector<double> kPoseNumbers{1, 2, 3, 0.1, 0.2, 0.3, 0.9};

Cdr startedWithHeader() {
  Cdr cdr;
  cdr.stamp(1'317'042'275, 123'456'789).text("odom");
  return cdr;
}

TEST_F(BridgeWire, PoseStamped) {
  const RawReader reader(domain_, geometry_msgs_msg_dds__PoseStamped__desc, "rt/motorcade/pose");
  publisher_.publish(ros::PoseStamped{.header = kHeader, .pose = kPose});
  EXPECT_EQ(reader.next(), startedWithHeader().doubles(kPoseNumbers).bytes());
}

TEST_F(BridgeWire, Odometry) {
  const RawReader reader(domain_, nav_msgs_msg_dds__Odometry__desc, "rt/motorcade/odometry");
  ros::Odometry message{.header = kHeader, .child_frame_id = "base_link", .pose = kPose};
  message.linear_mps = {10, 11, 12};
  message.angular_radps = {13, 14, 15};
  std::vector<double> pose_covariance, twist_covariance;
  for (std::size_t i = 0; i < 36; ++i) {
    pose_covariance.push_back(message.pose_covariance[i] = 100.0 + static_cast<double>(i));
    twist_covariance.push_back(message.twist_covariance[i] = 200.0 + static_cast<double>(i));
  }
  publisher_.publish(message);
  EXPECT_EQ(reader.next(), startedWithHeader()
                               .text("base_link")
                               .doubles(kPoseNumbers)
                               .doubles(pose_covariance)
                               .doubles({10, 11, 12, 13, 14, 15})
                               .doubles(twist_covariance)
                               .bytes());
}

TEST_F(BridgeWire, MarkerArray) {
  const RawReader reader(domain_, visualization_msgs_msg_dds__MarkerArray__desc, "rt/motorcade/objects");
  ros::Marker marker{.header = kHeader, .ns = "velocity", .id = 7, .type = ros::Marker::Type::kArrow, .pose = kPose};
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

}  // namespace
}  // namespace motorcade::test
