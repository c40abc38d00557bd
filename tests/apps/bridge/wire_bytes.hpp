#pragma once

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
#include <gmock/gmock.h>

#include "apps/bridge/dds/dds_publisher.hpp"
#include "tests/apps/bridge/claimed_domain.hpp"

/// Messages as bytes: those on the wire, and those that are written down by hand.
namespace motorcade::test {

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
  /// A covariance of `countedFrom`.
  Cdr& counted(double first) {
    for (int i = 0; i < 36; ++i) add(first + i);
    return *this;
  }
  Cdr& count(std::uint32_t count) { return add(count); }
  /// Bytes padded to four, as payloads of RTPS are; the header's last two bits tell by how much.
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
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    ddsi_serdata* data = nullptr;
    dds_sample_info_t info{};
    while (dds_takecdr(reader_, &data, 1, &info, DDS_ANY_STATE) <= 0) {
      if (std::chrono::steady_clock::now() > deadline) return {};
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
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
  const ClaimedDomain claimed_;

 protected:
  const int domain_ = claimed_.number();
  DdsPublisher publisher_{{.domain = domain_}, topicsOf(std::string(kDefaultTopics) + ",tf")};
};

const ros::Header kWiredHeader{.stamp = {1'317'042'275, 123'456'789}, .frame_id = "odom"};
const ros::Pose kWiredPose{.position = {1, 2, 3}, .orientation = {0.1, 0.2, 0.3, 0.9}};
const std::vector<double> kPoseNumbers{1, 2, 3, 0.1, 0.2, 0.3, 0.9};

inline Cdr startedWithHeader() {
  Cdr cdr;
  cdr.stamp(1'317'042'275, 123'456'789).text("odom");
  return cdr;
}

/// 36 numbers from `first` on.
inline ros::Covariance countedFrom(double first) {
  ros::Covariance covariance{};
  for (double& number : covariance) number = first++;
  return covariance;
}

}  // namespace motorcade::test
