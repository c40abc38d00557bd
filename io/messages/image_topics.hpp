#pragma once

#include <string>
#include <string_view>

/// ROS' conventions for the names of a camera's topics.
namespace motorcade {

/// True for images that were rectified before they were sent: `image_rect`, `image_rect_color`, ..., also compressed.
/// Their camera_info still describes the raw images.
bool isRectifiedTopic(std::string_view image_topic);

/// The camera_info beside an image topic: `/left/camera_info` of `/left/image_raw` and `/left/image_raw/compressed`.
std::string cameraInfoTopicOf(std::string_view image_topic);

}  // namespace motorcade
