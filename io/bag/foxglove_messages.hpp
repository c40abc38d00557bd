#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "io/messages/camera_info_message.hpp"
#include "io/messages/image_message.hpp"

/// Foxglove's RawImage, CompressedImage and CameraCalibration in Protobuf, converted to the equivalent messages of ROS.
/// Throws InputError that begins with `name`. The bytes of images remain the message's.
namespace motorcade {

/// The field `timestamp`, which is the first of each.
std::int64_t stampOfFoxglove(std::span<const std::uint8_t> message, const std::string& name);

ImageMessage readFoxgloveImage(std::span<const std::uint8_t> message, const std::string& name);
CompressedImageMessage readFoxgloveCompressedImage(std::span<const std::uint8_t> message, const std::string& name);
CameraInfoMessage readFoxgloveCalibration(std::span<const std::uint8_t> message, const std::string& name);

}  // namespace motorcade
