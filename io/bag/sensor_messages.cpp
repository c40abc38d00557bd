#include "io/bag/sensor_messages.hpp"

#include "io/bag/foxglove_messages.hpp"

namespace motorcade {
namespace {

struct MessageHead {
  std::int64_t stamp_ns = 0;
  std::string frame_id{};
};

MessageHead readHead(WireReader& reader) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const bool ros1 = reader.format() == WireFormat::kRos1;
  if (ros1) reader.u32();  // the counter
  const std::uint32_t seconds = reader.u32(), nanoseconds = reader.u32();
  // ROS 2's seconds have a sign.
  const std::int64_t whole_s = ros1 ? std::int64_t{seconds} : std::int64_t{static_cast<std::int32_t>(seconds)};
  return {whole_s * kSecond_ns + nanoseconds, reader.text()};
}

/// Binning and region of interest; true where the images are not the sensor's whole.
bool readReduction(WireReader& reader, const CameraInfoMessage& info) {
  const std::uint32_t binning_x = reader.u32(), binning_y = reader.u32();
  const std::uint32_t x = reader.u32(), y = reader.u32(), height = reader.u32(), width = reader.u32();
  const bool whole = (width == 0 || width == info.width) && (height == 0 || height == info.height);
  return binning_x > 1 || binning_y > 1 || x != 0 || y != 0 || !whole;
}

}  // namespace

std::optional<SensorMessage> sensorMessageNamed(std::string_view type) {
  if (type == "foxglove.RawImage") return SensorMessage::kImage;
  if (type == "foxglove.CompressedImage") return SensorMessage::kCompressedImage;
  if (type == "foxglove.CameraCalibration") return SensorMessage::kCameraInfo;
  if (!type.starts_with("sensor_msgs/")) return std::nullopt;
  const std::string_view name = type.substr(type.rfind('/') + 1);
  if (name == "Image") return SensorMessage::kImage;
  if (name == "CompressedImage") return SensorMessage::kCompressedImage;
  if (name == "CameraInfo") return SensorMessage::kCameraInfo;
  return std::nullopt;
}

std::optional<WireFormat> wireFormatNamed(std::string_view encoding) {
  if (encoding == "cdr") return WireFormat::kCdr;
  if (encoding == "ros1") return WireFormat::kRos1;
  if (encoding == "protobuf") return WireFormat::kProtobuf;
  return std::nullopt;
}

std::int64_t stampOfMessage(WireReader reader) {
  if (reader.format() == WireFormat::kProtobuf) return stampOfFoxglove(reader.message(), reader.name());
  return readHead(reader).stamp_ns;
}

ImageMessage readImageMessage(WireReader reader) {
  if (reader.format() == WireFormat::kProtobuf) return readFoxgloveImage(reader.message(), reader.name());
  ImageMessage image;
  MessageHead head = readHead(reader);
  image.stamp_ns = head.stamp_ns;
  image.frame_id = std::move(head.frame_id);
  image.height = reader.u32();
  image.width = reader.u32();
  image.encoding = reader.text();
  image.is_bigendian = reader.u8() != 0;
  image.step = reader.u32();
  image.data = reader.bytes();
  return image;
}

CompressedImageMessage readCompressedImageMessage(WireReader reader) {
  if (reader.format() == WireFormat::kProtobuf) return readFoxgloveCompressedImage(reader.message(), reader.name());
  CompressedImageMessage image;
  MessageHead head = readHead(reader);
  image.stamp_ns = head.stamp_ns;
  image.frame_id = std::move(head.frame_id);
  image.format = reader.text();
  image.data = reader.bytes();
  return image;
}

CameraInfoMessage readCameraInfoMessage(WireReader reader) {
  if (reader.format() == WireFormat::kProtobuf) return readFoxgloveCalibration(reader.message(), reader.name());
  CameraInfoMessage info;
  MessageHead head = readHead(reader);
  info.stamp_ns = head.stamp_ns;
  info.frame_id = std::move(head.frame_id);
  info.height = reader.u32();
  info.width = reader.u32();
  info.distortion_model = reader.text();
  info.D = reader.doubles(kMostCoefficients);
  reader.fill(info.K);
  reader.fill(info.R);
  reader.fill(info.P);
  info.reduced = readReduction(reader, info);
  return info;
}

}  // namespace motorcade
