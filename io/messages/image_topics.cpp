#include "io/messages/image_topics.hpp"

namespace motorcade {
namespace {

/// The topic without a transport such as `compressed`.
std::string_view withoutTransport(std::string_view topic) {
  constexpr std::string_view kCompressed = "/compressed";
  if (topic.ends_with(kCompressed)) topic.remove_suffix(kCompressed.size());
  return topic;
}

}  // namespace

bool isRectifiedTopic(std::string_view image_topic) {
  const std::string_view topic = withoutTransport(image_topic);
  const auto slash = topic.rfind('/');
  return topic.substr(slash == std::string_view::npos ? 0 : slash + 1).starts_with("image_rect");
}

std::string cameraInfoTopicOf(std::string_view image_topic) {
  const std::string_view topic = withoutTransport(image_topic);
  const auto slash = topic.rfind('/');
  return std::string(topic.substr(0, slash == std::string_view::npos ? 0 : slash + 1)) + "camera_info";
}

}  // namespace motorcade
