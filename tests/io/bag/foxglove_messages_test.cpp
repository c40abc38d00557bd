#include "io/bag/foxglove_messages.hpp"

#include <bit>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/bag/sensor_messages.hpp"
#include "io/files/errors.hpp"
#include "tests/io/images/image_samples.hpp"

namespace motorcade {
namespace {

/// Fields of a Protobuf message byte by byte.
class ProtobufText {
 public:
  ProtobufText& varint(int number, std::uint64_t value) { return plain(8ULL * number).plain(value); }
  ProtobufText& fixed32(int number, std::uint64_t value) { return plain(8ULL * number + 5).little(value, 4); }
  ProtobufText& bytes(int number, const std::string& value) {
    plain(8ULL * number + 2).plain(value.size());
    text_ += value;
    return *this;
  }
  ProtobufText& doubles(int number, const std::vector<double>& values) {
    plain(8ULL * number + 2).plain(8 * values.size());
    for (const double value : values) little(std::bit_cast<std::uint64_t>(value), 8);
    return *this;
  }
  ProtobufText& stamp(std::uint64_t seconds, std::uint64_t nanoseconds) {
    return bytes(1, ProtobufText().varint(1, seconds).varint(2, nanoseconds).text());
  }
  const std::string& text() const { return text_; }

 private:
  ProtobufText& plain(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) text_ += static_cast<char>(value | 0x80);
    text_ += static_cast<char>(value);
    return *this;
  }
  ProtobufText& little(std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) text_ += static_cast<char>(value >> (8 * i) & 0xFF);
    return *this;
  }
  std::string text_;
};

WireReader protobufReader(const std::string& message) {
  return {{reinterpret_cast<const std::uint8_t*>(message.data()), message.size()}, WireFormat::kProtobuf, "bag"};
}

std::string foxgloveImage() {
  std::string pixels;
  for (int i = 0; i < 32 * 20; ++i) pixels += static_cast<char>(i);
  return ProtobufText()
      .stamp(1'317'384'506, 174'740'992)
      .fixed32(2, 32)
      .fixed32(3, 20)
      .bytes(4, "mono8")
      .fixed32(5, 32)
      .bytes(6, pixels)
      .bytes(7, "cam")
      .text();
}

std::string foxgloveCalibration() {
  return ProtobufText()
      .fixed32(2, 320)
      .fixed32(3, 160)
      .bytes(4, "plumb_bob")
      .doubles(5, {-0.2, 0, 0, 0, 0})
      .doubles(6, {300, 0, 160, 0, 300, 80, 0, 0, 1})
      .doubles(7, {1, 0, 0, 0, 1, 0, 0, 0, 1})
      .doubles(8, {300, 0, 160, -150, 0, 300, 80, 0, 0, 0, 1, 0})
      .text();
}

TEST(FoxgloveMessages, ImagesHaveTheirTimeAndPixels) {
  const std::string text = foxgloveImage();
  const ImageMessage message = readImageMessage(protobufReader(text));
  EXPECT_EQ(message.stamp_ns, 1'317'384'506'174'740'992);
  EXPECT_EQ(stampOfMessage(protobufReader(text)), message.stamp_ns);
  EXPECT_EQ(message.frame_id, "cam");
  ImagePool pool;
  const Image image = grayImageOf(message, "bag", pool);
  EXPECT_EQ(image.at(5, 3), 3 * 32 + 5);
}

TEST(FoxgloveMessages, CompressedImagesAreFiles) {
  const std::string text = ProtobufText().stamp(1, 2).bytes(2, "a file").bytes(3, "jpeg").bytes(4, "cam").text();
  const CompressedImageMessage message = readCompressedImageMessage(protobufReader(text));
  EXPECT_EQ(message.stamp_ns, 1'000'000'002);
  EXPECT_EQ(message.format, "jpeg");
  EXPECT_EQ(std::string(message.data.begin(), message.data.end()), "a file");
}

TEST(FoxgloveMessages, CalibrationsAreCameraInfos) {
  const std::string text = foxgloveCalibration();
  const CameraInfoMessage info = readCameraInfoMessage(protobufReader(text));
  EXPECT_EQ(info.width, 320U);
  EXPECT_EQ(info.height, 160U);
  EXPECT_EQ(info.distortion_model, "plumb_bob");
  EXPECT_EQ(info.D.front(), -0.2);
  EXPECT_EQ(info.K[5], 80);
  EXPECT_EQ(info.R[4], 1);
  EXPECT_EQ(info.P[3], -150);
}

TEST(FoxgloveMessages, WhatIsNoSuchMessageIsRefused) {
  const std::string image = foxgloveImage(), calibration = foxgloveCalibration();
  for (const std::string& text :
       {std::string("\x0B"), std::string(11, '\xFF'), ProtobufText().doubles(6, {1, 2}).text(),
        ProtobufText().stamp(1ULL << 62, 0).text(), calibration.substr(0, 300),
        ProtobufText().doubles(5, std::vector<double>(100)).text()})
    EXPECT_THROW(readCameraInfoMessage(protobufReader(text)), InputError) << text.size();
  const std::string cut = image.substr(0, image.size() - 1);
  EXPECT_THROW(readImageMessage(protobufReader(cut)), InputError);
  EXPECT_EQ(wireFormatNamed("protobuf"), WireFormat::kProtobuf);
  EXPECT_EQ(sensorMessageNamed("foxglove.RawImage"), SensorMessage::kImage);
  EXPECT_EQ(sensorMessageNamed("foxglove.CompressedImage"), SensorMessage::kCompressedImage);
  EXPECT_EQ(sensorMessageNamed("foxglove.CameraCalibration"), SensorMessage::kCameraInfo);
}

}  // namespace
}  // namespace motorcade
