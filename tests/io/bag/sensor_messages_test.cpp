#include "io/bag/sensor_messages.hpp"

#include <string>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/images/image_samples.hpp"
#include "tests/support/ros_message_text.hpp"

namespace motorcade {
namespace {

using test::Wire;

constexpr Wire kWires[] = {Wire::kCdr, Wire::kBigCdr, Wire::kCdr2, Wire::kRos1};

WireReader readerOf(const std::string& message, Wire wire) {
  return {{reinterpret_cast<const std::uint8_t*>(message.data()), message.size()},
          wire == Wire::kRos1 ? WireFormat::kRos1 : WireFormat::kCdr,
          "bag"};
}

TEST(SensorMessages, ImagesAreReadFromEveryWire) {
  ImagePool pool;
  const Image image = test::noise(37, 21, pool);
  for (const Wire wire : kWires) {
    const std::string text = test::rosImage(wire, 1'317'384'506'174'740'992, image);
    const ImageMessage message = readImageMessage(readerOf(text, wire));
    EXPECT_EQ(message.stamp_ns, 1'317'384'506'174'740'992);
    EXPECT_EQ(message.frame_id, "cam");
    EXPECT_EQ(message.encoding, "mono8");
    test::expectEqual(grayImageOf(message, "bag", pool), image);
    EXPECT_EQ(stampOfMessage(readerOf(text, wire)), message.stamp_ns);
  }
}

TEST(SensorMessages, CompressedImagesAreReadFromEveryWire) {
  for (const Wire wire : kWires) {
    const std::string text = test::rosCompressedImage(wire, 5, "a file");
    const CompressedImageMessage message = readCompressedImageMessage(readerOf(text, wire));
    EXPECT_EQ(message.stamp_ns, 5);
    EXPECT_EQ(message.format, "jpeg");
    EXPECT_EQ(std::string(message.data.begin(), message.data.end()), "a file");
  }
}

TEST(SensorMessages, CameraInfosAreReadFromEveryWire) {
  for (const Wire wire : kWires) {
    const std::string text = test::rosCameraInfo(wire, 0.5);
    const CameraInfoMessage info = readCameraInfoMessage(readerOf(text, wire));
    EXPECT_EQ(info.width, 320U);
    EXPECT_EQ(info.height, 160U);
    EXPECT_EQ(info.distortion_model, "plumb_bob");
    EXPECT_EQ(info.D.size(), 5U);
    EXPECT_EQ(info.K[5], 80);
    EXPECT_EQ(info.R[8], 1);
    EXPECT_EQ(info.P[3], -150);
    EXPECT_FALSE(info.reduced);
    EXPECT_TRUE(readCameraInfoMessage(readerOf(test::rosCameraInfo(wire, 0.5, 2), wire)).reduced);
  }
}

TEST(SensorMessages, AMessageThatIsCutOffIsRefusedWhereverItEnds) {
  ImagePool pool;
  for (const Wire wire : kWires) {
    const std::string image = test::rosImage(wire, 5, test::noise(16, 16, pool)), info = test::rosCameraInfo(wire, 0.5);
    for (std::size_t size = 0; size < image.size(); ++size) {
      const std::string cut = image.substr(0, size);
      EXPECT_THROW(readImageMessage(readerOf(cut, wire)), InputError) << size;
    }
    for (std::size_t size = 0; size < info.size() - 1; ++size) {  // the last byte is not looked at
      const std::string cut = info.substr(0, size);
      EXPECT_THROW(readCameraInfoMessage(readerOf(cut, wire)), InputError) << size;
    }
  }
}

TEST(SensorMessages, OtherFormsAreRefused) {
  const std::string parameter_list("\0\3\0\0", 4), none("\1\1\0\0", 4);
  EXPECT_THROW(readerOf(parameter_list, Wire::kCdr), InputError);
  EXPECT_THROW(readerOf(none, Wire::kCdr), InputError);
  EXPECT_EQ(wireFormatNamed("json"), std::nullopt);
  EXPECT_EQ(sensorMessageNamed("sensor_msgs/msg/Imu"), std::nullopt);
  EXPECT_EQ(sensorMessageNamed("my_msgs/Image"), std::nullopt);
  EXPECT_EQ(sensorMessageNamed("sensor_msgs/Image"), SensorMessage::kImage);
  EXPECT_EQ(sensorMessageNamed("sensor_msgs/msg/CompressedImage"), SensorMessage::kCompressedImage);
}

}  // namespace
}  // namespace motorcade
