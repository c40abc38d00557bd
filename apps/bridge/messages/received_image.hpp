#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include "io/messages/image_message.hpp"

namespace motorcade {

/// An image as it came, and the owner of its bytes.
struct ReceivedImage {
  std::int64_t stamp_ns = 0;
  std::variant<ImageMessage, CompressedImageMessage> message{};
  std::shared_ptr<const void> holder{};
};

/// Names of a camera's topics, as ROS has them: `/left/image_raw`.
struct CameraTopics {
  std::string image{}, info{};  // no info: it is not read
};

}  // namespace motorcade
