#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/bag/wire_reader.hpp"
#include "io/messages/camera_info_message.hpp"
#include "io/messages/image_message.hpp"

/// Messages of ROS' sensor_msgs as stored in a bag, and Foxglove's of the same meaning. ROS 1 and ROS 2 have the same
/// fields, but for a counter in the header of ROS 1. Throws InputError that begins with `name`.
namespace motorcade {

enum class SensorMessage { kImage, kCompressedImage, kCameraInfo };

/// The message of a type, named as in ROS 1 (`sensor_msgs/Image`), ROS 2 (`sensor_msgs/msg/Image`) or Foxglove
/// (`foxglove.RawImage`).
std::optional<SensorMessage> sensorMessageNamed(std::string_view type);
/// `cdr`, `ros1` or `protobuf`; empty for other encodings.
std::optional<WireFormat> wireFormatNamed(std::string_view encoding);

/// The time of the header, with which each of them begins; 0 where the sender left it out.
std::int64_t stampOfMessage(WireReader reader);

/// The bytes of images remain the message's.
ImageMessage readImageMessage(WireReader reader);
CompressedImageMessage readCompressedImageMessage(WireReader reader);
CameraInfoMessage readCameraInfoMessage(WireReader reader);

}  // namespace motorcade
