#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.hpp"

/// Messages of ROS' sensor_msgs byte by byte, as bags have them.
namespace motorcade::test {

enum class Wire { kCdr, kBigCdr, kCdr2, kRos1 };

class RosMessageText {
 public:
  explicit RosMessageText(Wire wire) : wire_(wire) {
    if (wire != Wire::kRos1)
      text_ = {'\0', wire == Wire::kBigCdr ? '\0' : wire == Wire::kCdr ? '\1' : '\7', '\0', '\0'};
  }

  RosMessageText& u8(std::uint8_t value) { return number(value, 1); }
  RosMessageText& u32(std::uint64_t value) { return number(value, 4); }
  RosMessageText& f64(double value) { return number(std::bit_cast<std::uint64_t>(value), 8); }
  RosMessageText& word(std::string_view value) {
    const bool ends = wire_ != Wire::kRos1;  // with a zero
    u32(value.size() + (ends ? 1 : 0));
    text_ += value;
    if (ends) text_ += '\0';
    return *this;
  }
  RosMessageText& bytes(std::string_view value) {
    u32(value.size());
    text_ += value;
    return *this;
  }
  RosMessageText& head(std::int64_t stamp_ns) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    if (wire_ == Wire::kRos1) u32(7);  // a counter
    return u32(static_cast<std::uint64_t>(stamp_ns / kSecond_ns))
        .u32(static_cast<std::uint64_t>(stamp_ns % kSecond_ns))
        .word("cam");
  }
  const std::string& text() const { return text_; }

 private:
  RosMessageText& number(std::uint64_t value, std::size_t size) {
    constexpr std::size_t kHead = 4;
    const std::size_t alignment = wire_ == Wire::kRos1 ? 1 : wire_ == Wire::kCdr2 && size > 4 ? 4 : size;
    while ((text_.size() + kHead) % alignment != 0) text_ += '\0';
    for (std::size_t i = 0; i < size; ++i)
      text_ += static_cast<char>(value >> (8 * (wire_ == Wire::kBigCdr ? size - 1 - i : i)) & 0xFF);
    return *this;
  }

  Wire wire_;
  std::string text_;
};

inline std::string rosImage(Wire wire, std::int64_t stamp_ns, const Image& image) {
  std::string pixels;
  for (int y = 0; y < image.height(); ++y)
    pixels.append(reinterpret_cast<const char*>(image.row(y)), static_cast<std::size_t>(image.width()));
  const auto width = static_cast<std::uint32_t>(image.width()), height = static_cast<std::uint32_t>(image.height());
  return RosMessageText(wire).head(stamp_ns).u32(height).u32(width).word("mono8").u8(0).u32(width).bytes(pixels).text();
}

inline std::string rosCompressedImage(Wire wire, std::int64_t stamp_ns, std::string_view file) {
  return RosMessageText(wire).head(stamp_ns).word("jpeg").bytes(file).text();
}

/// A camera of a rectified pair, 300 px long, with its middle in that of 320 x 160 pixels.
inline std::string rosCameraInfo(Wire wire, double baseline_m, std::uint32_t binning = 0, double k1 = 0) {
  RosMessageText message(wire);
  message.head(0).u32(160).u32(320).word("plumb_bob").u32(5);
  const auto fill = [&](const std::vector<double>& values) {
    for (const double value : values) message.f64(value);
  };
  fill({k1, 0, 0, 0, 0});
  fill({300, 0, 160, 0, 300, 80, 0, 0, 1});
  fill({1, 0, 0, 0, 1, 0, 0, 0, 1});
  fill({300, 0, 160, -300 * baseline_m, 0, 300, 80, 0, 0, 0, 1, 0});
  return message.u32(binning).u32(binning).u32(0).u32(0).u32(0).u32(0).u8(0).text();
}

}  // namespace motorcade::test
