#include <array>
#include <cstdint>

#include <gmock/gmock.h>
#include <sensor_msgs.h>

#include "apps/bridge/dds/dds_values.hpp"
#include "tests/apps/bridge/bridged_cameras.hpp"
#include "tests/apps/bridge/claimed_domain.hpp"
#include "tests/apps/bridge/wire_bytes.hpp"

/// Compares the bytes of cameras' messages with ROS 2's definitions, as bridge_wire_test.cpp does for results, and
/// tests how messages are read.
namespace motorcade::test {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kSentAt_ns = 1'317'042'275'123'456'789;

Cdr startedByCamera() {
  Cdr cdr;
  cdr.stamp(1'317'042'275, 123'456'789).text("camera");
  return cdr;
}

class BridgeWireImages : public testing::Test {
  const ClaimedDomain claimed_;

 protected:
  const int domain_ = claimed_.number();
};

TEST_F(BridgeWireImages, Image) {
  const CameraPublishers cameras(domain_, Driver::kReliable);
  const RawReader reader(domain_, sensor_msgs_msg_dds__Image__desc, "rt/right/image_raw");
  const std::array<std::uint8_t, 8> pixels{1, 2, 3, 0, 4, 5, 6, 0};
  cameras.publish(StereoSide::kRight, {.pixels = pixels.data(), .width_px = 3, .height_px = 2, .stride_bytes = 4},
                  kSentAt_ns);
  Cdr expected = startedByCamera();
  expected.count(2).count(3).text("mono8").add<std::uint8_t>(0).count(3).count(6);  // height, width, ..., step, data
  for (std::uint8_t pixel = 1; pixel <= 6; ++pixel) expected.add(pixel);
  EXPECT_EQ(reader.next(), expected.bytes());
}

TEST_F(BridgeWireImages, CompressedImage) {
  const CameraPublishers cameras(domain_, Driver::kReliable, /*compressed=*/true);
  const RawReader reader(domain_, sensor_msgs_msg_dds__CompressedImage__desc, "rt/left/image_raw/compressed");
  cameras.publish(StereoSide::kLeft, "\x7", kSentAt_ns);
  Cdr expected = startedByCamera();
  expected.text("mono8; png compressed").count(1).add<std::uint8_t>(7);
  EXPECT_EQ(reader.next(), expected.bytes());
}

TEST_F(BridgeWireImages, CameraInfo) {
  const CameraPublishers cameras(domain_, Driver::kReliable);
  const RawReader reader(domain_, sensor_msgs_msg_dds__CameraInfo__desc, "rt/right/camera_info");
  cameras.publishInfos(
      {.width_px = 640, .height_px = 480, .fx_px = 500, .fy_px = 501, .cx_px = 320, .cy_px = 240, .baseline_m = 0.5},
      kSentAt_ns);
  Cdr expected = startedByCamera();
  expected.count(480).count(640).text("plumb_bob").count(0);          // no coefficients
  expected.doubles({500, 0, 320, 0, 501, 240, 0, 0, 1});              // k
  expected.doubles({1, 0, 0, 0, 1, 0, 0, 0, 1});                      // r
  expected.doubles({500, 0, 320, -250, 0, 501, 240, 0, 0, 0, 1, 0});  // p
  expected.count(0).count(0).count(0).count(0).count(0).count(0);     // binning, region of interest
  expected.add<std::uint8_t>(0);                                      // do_rectify
  EXPECT_EQ(reader.next(), expected.bytes());
}

TEST(DdsImages, AreReadFieldByField) {
  std::array<std::uint8_t, 4> pixels{1, 2, 3, 4};
  std::string encoding = "mono16";
  sensor_msgs_msg_dds__Image_ sample{};
  sample.header.stamp = {3, 4};
  sample.width = 2, sample.height = 1, sample.step = 4;
  sample.is_bigendian = 1;
  sample.encoding = encoding.data();
  sample.data = {._maximum = 4, ._length = 4, ._buffer = pixels.data(), ._release = false};
  const ImageMessage message = imageMessageOf(sample);
  EXPECT_EQ(message.stamp_ns, 3'000'000'004);
  EXPECT_EQ(message.width, 2U);
  EXPECT_EQ(message.height, 1U);
  EXPECT_EQ(message.step, 4U);
  EXPECT_TRUE(message.is_bigendian);
  EXPECT_EQ(message.encoding, "mono16");
  EXPECT_THAT(message.data, ElementsAre(1, 2, 3, 4));
}

TEST(DdsImages, CameraInfoOfAPartOfTheSensorIsMarked) {
  sensor_msgs_msg_dds__CameraInfo_ sample{};
  sample.width = 640, sample.height = 480;
  EXPECT_FALSE(cameraInfoMessageOf(sample).reduced);
  sample.roi.width = 640, sample.roi.height = 480;
  EXPECT_FALSE(cameraInfoMessageOf(sample).reduced) << "all of it";
  sample.roi.y_offset = 2;
  EXPECT_TRUE(cameraInfoMessageOf(sample).reduced);
  sample.roi.y_offset = 0, sample.binning_x = 2;
  EXPECT_TRUE(cameraInfoMessageOf(sample).reduced);
}

TEST(DdsImages, CoefficientsBeyondThoseOfAnyModelFillNoMemory) {
  std::vector<double> many(1000, 0.1);
  sensor_msgs_msg_dds__CameraInfo_ sample{};
  sample.d = ddsSequence<decltype(sample.d)>(many);
  EXPECT_EQ(cameraInfoMessageOf(sample).D.size(), kMostCoefficients + 1);
}

}  // namespace
}  // namespace motorcade::test
