#include "io/messages/image_message.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/images/image_samples.hpp"
#include "tests/io/images/png_sample.hpp"

namespace motorcade {
namespace {

using testing::HasSubstr;

constexpr int kMessageWidth = 20, kMessageHeight = 17;

/// A message with counted bytes, and some between the rows.
struct CountedMessage {
  explicit CountedMessage(const std::string& encoding, std::size_t pixel_bytes, std::size_t gap = 3) {
    const std::size_t step = kMessageWidth * pixel_bytes + gap;
    for (std::size_t i = 0; i < step * kMessageHeight; ++i) bytes.push_back(static_cast<std::uint8_t>(7 * i + i / 97));
    message = {.width = kMessageWidth,
               .height = kMessageHeight,
               .encoding = encoding,
               .step = static_cast<std::uint32_t>(step),
               .data = bytes};
  }
  const std::uint8_t* at(int x, int y, std::size_t pixel_bytes) const {
    return &bytes[message.step * static_cast<std::size_t>(y) + pixel_bytes * static_cast<std::size_t>(x)];
  }

  std::vector<std::uint8_t> bytes;
  ImageMessage message;
};

CompressedImageMessage compressedMessage(const std::string& file, const std::string& format) {
  return {.format = format, .data = {reinterpret_cast<const std::uint8_t*>(file.data()), file.size()}};
}

template <class Message>
std::string refusalOf(const Message& message, const MessageConversion& conversion = {}) {
  ImagePool pool;
  try {
    grayImageOf(message, "/left", pool, conversion);
  } catch (const InputError& error) {
    return error.what();
  }
  return "taken";
}

TEST(ImageMessage, GrayPixelsAreThoseThatWereSent) {
  ImagePool pool;
  for (const char* encoding : {"mono8", "8UC1"}) {
    const CountedMessage counted(encoding, 1);
    const Image image = grayImageOf(counted.message, "/left", pool);
    for (int y = 0; y < kMessageHeight; ++y)
      for (int x = 0; x < kMessageWidth; ++x) ASSERT_EQ(image.at(x, y), *counted.at(x, y, 1));
  }
}

TEST(ImageMessage, ColorsAreWeighedInTheOrderOfTheirEncoding) {
  struct Order {
    const char* encoding;
    std::size_t pixel_bytes, red, blue;
  };
  ImagePool pool;
  for (const Order& order : {Order{"rgb8", 3, 0, 2}, {"bgr8", 3, 2, 0}, {"rgba8", 4, 0, 2}, {"bgra8", 4, 2, 0}}) {
    const CountedMessage counted(order.encoding, order.pixel_bytes);
    const Image image = grayImageOf(counted.message, "/left", pool);
    for (int x = 0; x < kMessageWidth; ++x) {
      const std::uint8_t* pixel = counted.at(x, 5, order.pixel_bytes);
      ASSERT_EQ(image.at(x, 5), grayOf(pixel[order.red], pixel[1], pixel[order.blue])) << order.encoding;
    }
    EXPECT_EQ(imageHeaderOf(counted.message, "/left").channels, 3);
  }
}

TEST(ImageMessage, TheLumaOfYuvIsGray) {
  ImagePool pool;
  const CountedMessage uyvy("yuv422", 2), yuyv("yuv422_yuy2", 2);
  EXPECT_EQ(grayImageOf(uyvy.message, "/left", pool).at(7, 3), uyvy.at(7, 3, 2)[1]);
  EXPECT_EQ(grayImageOf(yuyv.message, "/left", pool).at(7, 3), yuyv.at(7, 3, 2)[0]);
}

TEST(ImageMessage, DeepSamplesUseTheirUpperBitsInEitherByteOrder) {
  ImagePool pool;
  CountedMessage counted("mono16", 2);
  const std::uint8_t* pixel = counted.at(4, 6, 2);
  EXPECT_EQ(grayImageOf(counted.message, "/left", pool).at(4, 6), pixel[1]);
  const int little = 256 * pixel[1] + pixel[0];
  EXPECT_EQ(grayImageOf(counted.message, "/left", pool, {.sample_bits = 12}).at(4, 6), std::min(little >> 4, 255));
  counted.message.is_bigendian = true;
  EXPECT_EQ(grayImageOf(counted.message, "/left", pool).at(4, 6), pixel[0]);
  counted.bytes.assign(counted.bytes.size(), 1);
  counted.bytes[2 * kMessageWidth] = 250;  // between two rows
  *const_cast<std::uint8_t*>(counted.at(3, 2, 2)) = 9;
  EXPECT_EQ(brightestSampleOf(counted.message, "/left"), 256 * 9 + 1);
}

TEST(ImageMessage, MosaicsBecomeTheGrayOfTheirColors) {
  ImagePool pool;
  const CountedMessage named("bayer_grbg8", 1), unnamed("mono8", 1);
  const Image mosaic = grayImageOf(unnamed.message, "/left", pool);
  const Image gray = grayOfMosaic(mosaic, BayerPattern::kGrbg, pool);
  test::expectEqual(grayImageOf(named.message, "/left", pool), gray);
  test::expectEqual(grayImageOf(unnamed.message, "/left", pool, {.bayer = BayerPattern::kGrbg}), gray);
  EXPECT_THAT(refusalOf(CountedMessage("rgb8", 3).message, {.bayer = BayerPattern::kGrbg}), HasSubstr("has colors"));
}

TEST(ImageMessage, CompressedImagesAreThoseOfTheirFiles) {
  ImagePool pool;
  const Image image = test::noise(61, 37, pool);
  const std::string jpeg = test::jpegOf(image);
  const Image decoded = decodeImage(jpeg, "image.jpg", pool);
  test::expectEqual(grayImageOf(compressedMessage(jpeg, "jpeg"), "/left", pool), decoded);
  test::expectEqual(grayImageOf(compressedMessage(jpeg, "bayer_rggb8; jpeg compressed "), "/left", pool),
                    grayOfMosaic(decoded, BayerPattern::kRggb, pool));
  const std::string png = test::PngSample{.bits = 16}.write();
  EXPECT_EQ(imageHeaderOf(compressedMessage(png, "png"), "/left").bits, 16);
  EXPECT_EQ(brightestSampleOf(compressedMessage(png, "png"), "/left"), brightestSampleIn(png, "image.png"));
}

TEST(ImageMessage, NothingBeyondItsBytesIsRead) {
  CountedMessage counted("bgr8", 3, 0);
  const auto bytes = std::span<const std::uint8_t>(counted.bytes);
  counted.message.data = bytes.first(bytes.size() - 1);
  EXPECT_THAT(refusalOf(counted.message), HasSubstr("/left: has 1019 bytes of pixels, 17 rows need 1020"));
  counted.message.step = 59;
  EXPECT_THAT(refusalOf(counted.message), HasSubstr("a row has 59 bytes (step), 20 pixels of bgr8 need 60"));
  counted.message = {.width = 0xFFFFFFFF, .height = 0xFFFFFFFF, .encoding = "mono8", .step = 0xFFFFFFFF, .data = bytes};
  EXPECT_THAT(refusalOf(counted.message), HasSubstr("4294967295x4294967295"));
  EXPECT_THAT(refusalOf(compressedMessage("", "jpeg")), HasSubstr("/left"));
}

TEST(ImageMessage, OtherImagesThanExpectedAreNamed) {
  const CountedMessage counted("mono8", 1), depth("32FC1", 4);
  EXPECT_THAT(refusalOf(counted.message, {.size = ImageSize{20, 18}}),
              HasSubstr("20x17 pixels, those before have 20x18"));
  EXPECT_THAT(refusalOf(counted.message, {.max_pixels = 300}), HasSubstr("input.max_pixels"));
  EXPECT_THAT(refusalOf(depth.message), HasSubstr("'32FC1' is not read"));
}

}  // namespace
}  // namespace motorcade
