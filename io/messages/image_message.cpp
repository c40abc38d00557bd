#include "io/messages/image_message.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/images/image_codec.hpp"

namespace motorcade {
namespace {

/// The samples of a pixel that make its gray, by their place. The luma of YUV is gray already.
struct PixelKind {
  std::string_view encoding;
  int channels = 1;
  std::size_t sample_bytes = 1, pixel_bytes = 1;
  std::size_t red = 0, green = 0, blue = 0;  // offsets in bytes; all the same where there is one channel
};

constexpr std::array kPixelKinds{PixelKind{"mono8"},
                                 PixelKind{"8UC1"},
                                 PixelKind{"mono16", 1, 2, 2},
                                 PixelKind{"16UC1", 1, 2, 2},
                                 PixelKind{"rgb8", 3, 1, 3, 0, 1, 2},
                                 PixelKind{"bgr8", 3, 1, 3, 2, 1, 0},
                                 PixelKind{"8UC3", 3, 1, 3, 2, 1, 0},
                                 PixelKind{"rgba8", 3, 1, 4, 0, 1, 2},
                                 PixelKind{"bgra8", 3, 1, 4, 2, 1, 0},
                                 PixelKind{"8UC4", 3, 1, 4, 2, 1, 0},
                                 PixelKind{"rgb16", 3, 2, 6, 0, 2, 4},
                                 PixelKind{"bgr16", 3, 2, 6, 4, 2, 0},
                                 PixelKind{"yuv422", 1, 1, 2, 1, 1, 1},
                                 PixelKind{"uyvy", 1, 1, 2, 1, 1, 1},
                                 PixelKind{"yuv422_yuy2", 1, 1, 2},
                                 PixelKind{"yuyv", 1, 1, 2}};

/// The filters that an encoding or the beginning of a format names.
std::optional<BayerPattern> mosaicNamed(std::string_view encoding) {
  if (!encoding.starts_with("bayer_")) return std::nullopt;
  return bayerPatternOf(encoding.substr(0, encoding.find(';')));
}

PixelKind pixelKindOf(const ImageMessage& message, const std::string& name) {
  if (mosaicNamed(message.encoding)) return message.encoding.ends_with("16") ? kPixelKinds[2] : kPixelKinds[0];
  const auto found = std::ranges::find(kPixelKinds, message.encoding, &PixelKind::encoding);
  if (found == kPixelKinds.end())
    throw InputError(name + ": the encoding '" + printable(message.encoding) +
                     "' is not read; send mono8, mono16, rgb8, bgr8, rgba8, bgra8, bayer_*8 or yuv422");
  return *found;
}

/// Throws InputError where the rows do not fit into the message's bytes.
void requireBytes(const ImageMessage& message, const PixelKind& kind, const std::string& name) {
  const std::uint64_t row = kind.pixel_bytes * std::uint64_t{message.width};
  if (message.step < row)
    throw InputError(name + ": a row has " + std::to_string(message.step) + " bytes (step), " +
                     std::to_string(message.width) + " pixels of " + printable(message.encoding) + " need " +
                     std::to_string(row));
  const std::uint64_t needed = std::uint64_t{message.step} * (message.height - 1) + row;
  if (message.data.size() < needed)
    throw InputError(name + ": has " + std::to_string(message.data.size()) + " bytes of pixels, " +
                     std::to_string(message.height) + " rows need " + std::to_string(needed));
}

void requireExpected(const ImageHeader& header, const MessageConversion& conversion, const std::string& name) {
  if (conversion.size && header.size != *conversion.size)
    throw InputError(name + ": has " + header.size.text() + " pixels, those before have " + conversion.size->text());
  if (header.size.width * header.size.height > conversion.max_pixels)
    throw InputError(name + ": has " + header.size.text() + " pixels, more than " +
                     std::to_string(conversion.max_pixels) + " (input.max_pixels)");
}

unsigned sampleAt(const std::uint8_t* bytes, bool big_endian) {
  return big_endian ? 256U * bytes[0] + bytes[1] : 256U * bytes[1] + bytes[0];
}

/// Fills a row by a function that returns the 8-bit sample at a byte.
template <class Sample>
void fillGray(const std::uint8_t* pixels, const PixelKind& kind, Image& image, int y, const Sample& sample) {
  std::uint8_t* const gray = image.mutableRow(y);
  for (int x = 0; x < image.width(); ++x, pixels += kind.pixel_bytes)
    gray[x] = kind.channels == 1
                  ? sample(pixels + kind.red)
                  : grayOf(sample(pixels + kind.red), sample(pixels + kind.green), sample(pixels + kind.blue));
}

Image samplesOf(const ImageMessage& message, const PixelKind& kind, ImagePool& pool, int sample_bits) {
  Image image = pool.acquire(static_cast<int>(message.width), static_cast<int>(message.height));
  for (int y = 0; y < image.height(); ++y) {
    const std::uint8_t* const row = message.data.data() + std::size_t{message.step} * static_cast<std::size_t>(y);
    if (kind.pixel_bytes == 1)
      std::memcpy(image.mutableRow(y), row, message.width);
    else if (kind.sample_bytes == 1)
      fillGray(row, kind, image, y, [](const std::uint8_t* sample) { return *sample; });
    else
      fillGray(row, kind, image, y, [&](const std::uint8_t* sample) {
        return upperBits(sampleAt(sample, message.is_bigendian), sample_bits);
      });
  }
  return image;
}

std::string_view textOf(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

ImageHeader imageHeaderOf(const ImageMessage& message, const std::string& name) {
  const PixelKind kind = pixelKindOf(message, name);
  const ImageSize size = checkedSize(message.width, message.height, name);
  requireBytes(message, kind, name);
  return {.size = size, .channels = kind.channels, .bits = static_cast<int>(8 * kind.sample_bytes)};
}

ImageHeader imageHeaderOf(const CompressedImageMessage& message, const std::string& name) {
  return parseImageHeader(textOf(message.data), name);
}

int brightestSampleOf(const ImageMessage& message, const std::string& name) {
  if (imageHeaderOf(message, name).bits != kAllSampleBits) return 0;
  const PixelKind kind = pixelKindOf(message, name);
  unsigned brightest = 0;
  for (std::size_t y = 0; y < message.height; ++y)
    for (std::size_t x = 0; x < message.width * kind.pixel_bytes; x += kind.sample_bytes)
      brightest = std::max(brightest, sampleAt(&message.data[message.step * y + x], message.is_bigendian));
  return static_cast<int>(brightest);
}

int brightestSampleOf(const CompressedImageMessage& message, const std::string& name) {
  return brightestSampleIn(textOf(message.data), name);
}

Image grayImageOf(const ImageMessage& message, const std::string& name, ImagePool& pool,
                  const MessageConversion& conversion) {
  const ImageHeader header = imageHeaderOf(message, name);
  requireExpected(header, conversion, name);
  Image samples = samplesOf(message, pixelKindOf(message, name), pool, conversion.sample_bits);
  const auto named = mosaicNamed(message.encoding);
  const auto mosaic = named ? named : conversion.bayer;
  if (!mosaic) return samples;
  if (header.channels != 1) throw InputError(name + kNoMosaic);
  return grayOfMosaic(samples, *mosaic, pool);
}

/// Decodes a compressed message. A driver may have converted a mosaic to colors before compressing it.
Image grayImageOf(const CompressedImageMessage& message, const std::string& name, ImagePool& pool,
                  const MessageConversion& conversion) {
  const ImageHeader header = imageHeaderOf(message, name);
  requireExpected(header, conversion, name);
  if (conversion.bayer && header.channels != 1) throw InputError(name + kNoMosaic);
  const Image samples = decodeImage(textOf(message.data), name, pool, {.sample_bits = conversion.sample_bits});
  const auto named = mosaicNamed(message.format);
  const auto mosaic = named ? named : conversion.bayer;
  return mosaic && header.channels == 1 ? grayOfMosaic(samples, *mosaic, pool) : samples;
}

}  // namespace motorcade
