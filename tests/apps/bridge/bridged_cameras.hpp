#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <dds/dds.h>
#include <sensor_msgs.h>

#include "apps/bridge/dds/dds_configuration.hpp"
#include "apps/bridge/dds/dds_values.hpp"
#include "io/messages/stamp_pairing.hpp"
#include "motorcade/motorcade.hpp"

/// Two cameras as drivers of ROS 2 publish them, with the code that idlc makes of the public definitions.
namespace motorcade::test {

/// A driver's way to publish: ROS' sensor data are best effort.
enum class Driver { kReliable, kBestEffort };

/// Publishers of one domain, in this process.
class CameraPublishers {
 public:
  CameraPublishers(int domain, Driver driver, bool compressed = false)
      : domain_(
            made(dds_create_domain(static_cast<dds_domainid_t>(domain), ddsConfiguration({.domain = domain}).c_str()))),
        participant_(made(dds_create_participant(static_cast<dds_domainid_t>(domain), nullptr, nullptr))) {
    for (const char* const side : {"left", "right"}) {
      const std::string name = std::string("rt/") + side;
      images_.push_back(compressed
                            ? writer(sensor_msgs_msg_dds__CompressedImage__desc, name + "/image_raw/compressed", driver)
                            : writer(sensor_msgs_msg_dds__Image__desc, name + "/image_raw", driver));
      infos_.push_back(writer(sensor_msgs_msg_dds__CameraInfo__desc, name + "/camera_info", driver));
    }
    motion_ = writer(geometry_msgs_msg_dds__TwistWithCovarianceStamped__desc, "rt/vehicle/twist", driver);
  }
  ~CameraPublishers() { dds_delete(domain_); }
  CameraPublishers(const CameraPublishers&) = delete;
  CameraPublishers& operator=(const CameraPublishers&) = delete;

  /// False where a topic has no subscriber in time.
  bool areSubscribed(std::chrono::seconds patience, bool infos_too = true) const {
    std::vector<dds_entity_t> wanted = images_;
    if (infos_too) wanted.insert(wanted.end(), infos_.begin(), infos_.end());
    return allAreSubscribed(wanted, patience);
  }
  bool motionIsSubscribed(std::chrono::seconds patience) const { return allAreSubscribed({motion_}, patience); }

  /// Publishes gray of 8 bits, as mono8, or as the rgb8 that has the same gray.
  void publish(StereoSide side, const Pair::Image& image, std::int64_t stamp_ns, bool colors = false) const {
    std::vector<std::uint8_t> bytes;
    const auto* row = static_cast<const std::uint8_t*>(image.pixels);
    for (int y = 0; y < image.height_px; ++y, row += image.stride_bytes) {
      if (!colors) bytes.insert(bytes.end(), row, row + image.width_px);
      for (int x = 0; colors && x < image.width_px; ++x) bytes.insert(bytes.end(), 3, row[x]);
    }
    const std::string frame_id = "camera", encoding = colors ? "rgb8" : "mono8";
    sensor_msgs_msg_dds__Image_ message{};
    message.header = headerAt(stamp_ns, frame_id);
    message.width = static_cast<std::uint32_t>(image.width_px);
    message.height = static_cast<std::uint32_t>(image.height_px);
    message.encoding = ddsText(encoding);
    message.step = message.width * (colors ? 3 : 1);
    message.data = ddsSequence<decltype(message.data)>(bytes);
    write(images_[indexOf(side)], &message);
  }
  /// Publishes the vehicle's own motion.
  void publishMotion(double speed_mps, std::int64_t stamp_ns) const {
    const std::string frame_id = "base_link";
    geometry_msgs_msg_dds__TwistWithCovarianceStamped_ message{};
    message.header = headerAt(stamp_ns, frame_id);
    message.twist.twist.linear.x = speed_mps;
    write(motion_, &message);
  }
  /// Publishes the bytes of a file.
  void publish(StereoSide side, const std::string& file, std::int64_t stamp_ns) const {
    std::vector<std::uint8_t> bytes(file.begin(), file.end());
    const std::string frame_id = "camera", format = "mono8; png compressed";
    sensor_msgs_msg_dds__CompressedImage_ message{};
    message.header = headerAt(stamp_ns, frame_id);
    message.format = ddsText(format);
    message.data = ddsSequence<decltype(message.data)>(bytes);
    write(images_[indexOf(side)], &message);
  }
  /// Publishes the camera_info of a rectified pair.
  void publishInfos(const Camera& camera, std::int64_t stamp_ns) const {
    const std::string frame_id = "camera", model = "plumb_bob";
    for (const StereoSide side : kStereoSides) {
      sensor_msgs_msg_dds__CameraInfo_ message{};
      message.header = headerAt(stamp_ns, frame_id);
      message.width = static_cast<std::uint32_t>(camera.width_px);
      message.height = static_cast<std::uint32_t>(camera.height_px);
      message.distortion_model = ddsText(model);
      const double shift = side == StereoSide::kLeft ? 0 : -camera.fx_px * camera.baseline_m;
      const std::array k{camera.fx_px, 0.0, camera.cx_px, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 1.0};
      const std::array r{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
      const std::array p{camera.fx_px, 0.0, camera.cx_px, shift, 0.0, camera.fy_px,
                         camera.cy_px, 0.0, 0.0,          0.0,   1.0, 0.0};
      std::ranges::copy(k, message.k);
      std::ranges::copy(r, message.r);
      std::ranges::copy(p, message.p);
      write(infos_[indexOf(side)], &message);
    }
  }

 private:
  static bool allAreSubscribed(const std::vector<dds_entity_t>& wanted, std::chrono::seconds patience) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    for (const dds_entity_t writer : wanted)
      for (dds_publication_matched_status_t status{}; status.current_count == 0;) {
        dds_get_publication_matched_status(writer, &status);
        if (std::chrono::steady_clock::now() > deadline) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    return true;
  }
  static dds_entity_t made(dds_entity_t entity) {
    if (entity < 0) throw std::runtime_error(dds_strretcode(entity));
    return entity;
  }
  static std_msgs_msg_dds__Header_ headerAt(std::int64_t stamp_ns, const std::string& frame_id) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    return {
        .stamp = {static_cast<std::int32_t>(stamp_ns / kSecond_ns), static_cast<std::uint32_t>(stamp_ns % kSecond_ns)},
        .frame_id = ddsText(frame_id)};
  }
  /// Makes a writer; reliable ones keep all that is not acknowledged, and wait for room.
  dds_entity_t writer(const dds_topic_descriptor_t& type, const std::string& topic, Driver driver) const {
    dds_qos_t* const qos = dds_create_qos();
    if (driver == Driver::kReliable) {
      dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(60));
      dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
      dds_qset_resource_limits(qos, 4, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
    } else {
      dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
      dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 5);
    }
    const dds_entity_t entity = made(dds_create_topic(participant_, &type, topic.c_str(), nullptr, nullptr));
    const dds_entity_t result = made(dds_create_writer(participant_, entity, qos, nullptr));
    dds_delete_qos(qos);
    return result;
  }
  static void write(dds_entity_t writer, const void* message) {
    if (const auto outcome = dds_write(writer, message); outcome != DDS_RETCODE_OK)
      throw std::runtime_error(dds_strretcode(outcome));
  }

  dds_entity_t domain_, participant_;
  std::vector<dds_entity_t> images_{}, infos_{};
  dds_entity_t motion_ = 0;
};

}  // namespace motorcade::test
