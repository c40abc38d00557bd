#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "core/image.hpp"
#include "tests/support/mcap_text.hpp"
#include "tests/support/ros_message_text.hpp"

namespace motorcade::test {

/// A bag of small images, of which each tells its pair's number by its gray level.
class NumberedBag {
 public:
  static constexpr std::int64_t kPeriod_ns = 100'000'000;
  static constexpr const char* kTopics = "/left/image_raw,/right/image_raw";

  /// The lenses distort by k1.
  explicit NumberedBag(bool with_infos = true, double k1 = 0) {
    text_.magic().header();
    for (const char* side : {"left", "right"}) {
      const std::string name = std::string("/") + side;
      text_.topic(topic(side), name + "/image_raw", "sensor_msgs/msg/Image");
      if (with_infos) text_.topic(topic(side) + 2, name + "/camera_info", "sensor_msgs/msg/CameraInfo");
    }
    if (!with_infos) return;
    text_.message(topic("left") + 2, 0, rosCameraInfo(Wire::kCdr, 0, 0, k1));
    text_.message(topic("right") + 2, 0, rosCameraInfo(Wire::kCdr, 0.5, 0, k1));
  }

  static std::int64_t stampOf_ns(int number) { return (number + 1) * kPeriod_ns; }
  NumberedBag& left(int number) { return image("left", number, stampOf_ns(number)); }
  NumberedBag& right(int number) { return image("right", number, stampOf_ns(number)); }
  NumberedBag& image(const std::string& side, int number, std::int64_t stamp_ns) {
    return message(side, rosImage(Wire::kCdr, stamp_ns, filled(number)), stampOf_ns(number));
  }
  NumberedBag& message(const std::string& side, const std::string& data, std::int64_t log_ns) {
    text_.message(topic(side), static_cast<std::uint64_t>(log_ns), data);
    return *this;
  }
  NumberedBag& pairs(int begin, int end) {
    for (int number = begin; number < end; ++number) left(number).right(number);
    return *this;
  }
  /// The file without the end that a finished one has.
  const std::string& cut() const { return text_.text(); }
  std::string whole() const { return McapText(text_).end().text(); }

 private:
  static std::uint16_t topic(const std::string& side) { return side == "left" ? 1 : 2; }
  static Image filled(int level) {
    ImagePool pool;
    Image image = pool.acquire(320, 160);
    for (int y = 0; y < image.height(); ++y)
      std::fill_n(image.mutableRow(y), image.width(), static_cast<std::uint8_t>(level));
    return image;
  }

  McapText text_;
};

}  // namespace motorcade::test
