#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/image.hpp"
#include "io/images/bayer.hpp"
#include "io/images/image_file.hpp"
#include "io/images/sample_bits.hpp"

/// Images in messages as cameras' drivers send them, from any wire or file. `name` is for messages to the user; an
/// unusable message is an InputError that begins with it.
namespace motorcade {

/// ROS' sensor_msgs/Image. The receiver owns the bytes.
struct ImageMessage {
  std::int64_t stamp_ns = 0;
  std::string frame_id{};
  std::uint32_t width = 0, height = 0;
  std::string encoding{};  // mono8, bgr8, bayer_rggb8, ...
  bool is_bigendian = false;
  std::uint32_t step = 0;  // bytes from one row to the next
  std::span<const std::uint8_t> data{};
};

/// ROS' sensor_msgs/CompressedImage: the bytes of a JPEG or PNG file.
struct CompressedImageMessage {
  std::int64_t stamp_ns = 0;
  std::string frame_id{};
  std::string format{};  // jpeg, png, or as `bgr8; jpeg compressed bgr8`
  std::span<const std::uint8_t> data{};
};

/// The conversion to gray, the same for all images of a camera.
struct MessageConversion {
  std::optional<ImageSize> size{};      // others are refused
  int sample_bits = kAllSampleBits;     // that samples of 16 bits use, see `usedSampleBits`
  std::optional<BayerPattern> bayer{};  // of images with one channel whose message names no pattern
  int max_pixels = kMaxImage_pixels;    // larger images are refused
};

/// Size, channels and bits of a message. Throws unless it has the bytes for them.
ImageHeader imageHeaderOf(const ImageMessage& message, const std::string& name);
ImageHeader imageHeaderOf(const CompressedImageMessage& message, const std::string& name);

/// The brightest sample of an image of 16 bits; 0 of others.
int brightestSampleOf(const ImageMessage& message, const std::string& name);
int brightestSampleOf(const CompressedImageMessage& message, const std::string& name);

/// The image as 8-bit gray. Colors are weighted as those of files, mosaics become the gray of their colors.
Image grayImageOf(const ImageMessage& message, const std::string& name, ImagePool& pool,
                  const MessageConversion& conversion = {});
Image grayImageOf(const CompressedImageMessage& message, const std::string& name, ImagePool& pool,
                  const MessageConversion& conversion = {});

}  // namespace motorcade
