#include "apps/bridge/messages/pair_conversion.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/rig/remap.hpp"

namespace motorcade::test {
namespace {

constexpr int kWidth = 64, kHeight = 48;
const std::array<CameraTopics, 2> kCameraTopics{CameraTopics{"/l/image_raw", "/l/camera_info"},
                                                CameraTopics{"/r/image_raw", "/r/camera_info"}};

/// An image whose pixels are given by their place, in samples of one or two bytes.
ReceivedImage imageBy(const auto& sample, bool deep = false, int width = kWidth) {
  const auto bytes = std::make_shared<std::vector<std::uint8_t>>();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < width; ++x) {
      const int value = sample(x, y);
      bytes->push_back(static_cast<std::uint8_t>(value % 256));
      if (deep) bytes->push_back(static_cast<std::uint8_t>(value / 256));
    }
  const auto w = static_cast<std::uint32_t>(width);
  return {.message = ImageMessage{.width = w,
                                  .height = kHeight,
                                  .encoding = deep ? "mono16" : "mono8",
                                  .step = deep ? 2 * w : w,
                                  .data = *bytes},
          .holder = bytes};
}

int hill(int x, int y) { return 2 * x + y; }

CameraInfoMessage infoOf(double k1, double baseline_m) {
  constexpr double kF = 50, kCx = 32, kCy = 24;
  return {.width = kWidth,
          .height = kHeight,
          .distortion_model = "plumb_bob",
          .D = {k1, 0, 0, 0, 0},
          .K = {kF, 0, kCx, 0, kF, kCy, 0, 0, 1},
          .R = {1, 0, 0, 0, 1, 0, 0, 0, 1},
          .P = {kF, 0, kCx, -kF * baseline_m, 0, kF, kCy, 0, 0, 0, 1, 0}};
}

Sequence camerasWith(double k1) {
  return camerasOf({.topics = kCameraTopics, .infos = {infoOf(k1, 0), infoOf(k1, 0.5)}}, {kWidth, kHeight});
}

void expectPixels(const Image& image, const auto& expected) {
  ASSERT_EQ(image.width(), kWidth);
  ASSERT_EQ(image.height(), kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) ASSERT_EQ(image.at(x, y), expected(x, y)) << x << ", " << y;
}

TEST(PairConversion, RectifiedPairsStayAsTheyAre) {
  const Sequence cameras = camerasWith(0);
  EXPECT_EQ(cameras.camera.fx_px, 50);
  EXPECT_DOUBLE_EQ(cameras.camera.baseline_m, 0.5);
  EXPECT_EQ(cameras.camera.width_px, kWidth);
  PairConversion convert(cameras, kCameraTopics);
  const auto grays = convert({imageBy(hill), imageBy([](int x, int) { return x; })});
  expectPixels(grays.left, hill);
  expectPixels(grays.right, [](int x, int) { return x; });
}

TEST(PairConversion, RawPairsAreRectifiedByTheirCameraInfo) {
  const Sequence cameras = camerasWith(-0.2);
  ASSERT_TRUE(cameras.rectification);
  PairConversion convert(cameras, kCameraTopics);
  const auto grays = convert({imageBy(hill), imageBy(hill)});
  const Rectification& rig = *cameras.rectification;
  ImagePool pool;
  Image raw = pool.acquire(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) raw.mutableRow(y)[x] = static_cast<std::uint8_t>(hill(x, y));
  const Image expected = Remap(rig.left, rig.R_left, rig.camera, {kWidth, kHeight})(raw, pool);
  expectPixels(grays.left, [&](int x, int y) { return expected.at(x, y); });
  EXPECT_NE(grays.left.at(2, 2), hill(2, 2)) << "the corner moves";
}

TEST(PairConversion, DeepSamplesAreTakenByTheFirstBrightPairAndSoAreAllLater) {
  PairConversion convert(camerasWith(0), kCameraTopics);
  const auto all = [](int value) { return [value](int, int) { return value; }; };
  convert({imageBy(all(200), true), imageBy(all(200), true)});
  EXPECT_FALSE(convert.sampleBits()) << "a dark pair tells nothing";
  convert({imageBy(all(900), true), imageBy(all(3000), true)});
  EXPECT_EQ(convert.sampleBits(), 12);
  const auto grays = convert({imageBy(all(900), true), imageBy(all(900), true)});
  EXPECT_EQ(grays.left.at(0, 0), 900 >> 4);
}

TEST(PairConversion, AnotherSizeIsRefusedWithItsTopic) {
  PairConversion convert(camerasWith(0), kCameraTopics);
  try {
    convert({imageBy(hill), imageBy(hill, false, kWidth / 2)});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("/r/image_raw: has 32x48 pixels"));
  }
}

TEST(PairConversion, TheUsersCamerasNeedNoCameraInfo) {
  CameraKnowledge known{.topics = kCameraTopics};
  EXPECT_FALSE(known.complete());
  known.given.camera = "700,701,30,20,0.25";
  EXPECT_TRUE(known.complete());
  const Sequence cameras = camerasOf(known, {kWidth, kHeight});
  EXPECT_EQ(cameras.camera.fy_px, 701);
  EXPECT_FALSE(cameras.rectification);
}

}  // namespace
}  // namespace motorcade::test
