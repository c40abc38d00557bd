#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.hpp"
#include "io/images/image_limits.hpp"
#include "io/images/sample_bits.hpp"

/// Images in files. Formats are recognized by content, sizes are checked in the header before anything is allocated.
/// Reading throws InputError, writing OutputError, both naming the file.
namespace motorcade {

enum class ImageFormat { kUnknown, kPng, kJpeg, kPgm };

struct ImageSize {
  int width = 0, height = 0;
  bool operator==(const ImageSize&) const = default;
  std::string text() const { return std::to_string(width) + "x" + std::to_string(height); }
};

/// Properties of an image that its file's header states.
struct ImageHeader {
  ImageSize size;
  int channels = 1;   // 3 where it has colors; transparency is not counted
  int bits = 8;       // of a stored sample: 16 where it has more than 8
  int told_bits = 0;  // that the camera had, as a file of 16 bits says (PNG's sBIT); 0 where it does not
  int white = 0;      // the sample that is white, as a file of 16 bits says (PGM's maximum); 0 where it does not
  bool operator==(const ImageHeader&) const = default;
};

/// Color image, three bytes per pixel, rows without gaps.
struct RgbImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  std::uint8_t* at(int x, int y) { return &pixels[3 * (y * width + x)]; }
  const std::uint8_t* at(int x, int y) const { return &pixels[3 * (y * width + x)]; }
};

/// 16-bit gray image, rows without gaps: KITTI's disparity maps, instance masks.
struct Gray16Image {
  int width = 0, height = 0;
  std::vector<std::uint16_t> pixels;
};

/// True when the file's name says image (png, jpg, jpeg, pgm, ppm, pnm).
bool hasImageName(const std::filesystem::path& file);
/// The format by the first bytes; unknown also when the file cannot be read.
ImageFormat imageFormat(const std::filesystem::path& file);
/// Parses the header alone. Refuses sizes below 16 or above 16384 in either direction, more than 2^26 pixels, and
/// unsupported kinds of images.
ImageHeader readImageHeader(const std::filesystem::path& file);
ImageSize readImageSize(const std::filesystem::path& file);
/// The brightest sample of a file whose header declares 16 bits; 0 of others.
int readBrightestSample(const std::filesystem::path& file);

/// Any PNG, JPEG, PGM or PPM as 8-bit gray; color is weighted as in BT.601. Samples of 16 bits lose the lower byte or
/// are scaled as the file says. An unexpected size is refused by the header, a file of more than `max_mb` before it is
/// read.
Image readImage(const std::filesystem::path& file, ImagePool& pool, std::optional<ImageSize> expected = {},
                int max_mb = kMaxImageFile_mb);

/// Error message, after the file's name, for a color image that is declared to be a mosaic.
inline constexpr const char* kNoMosaic =
    ": has colors, so that it is no mosaic of a sensor; leave the Bayer pattern out";

/// Properties of a file's image that are known before the file is read.
struct ExpectedImage {
  std::optional<ImageSize> size{};
  int sample_bits = kAllSampleBits;  // that samples of 16 bits use, see `usedSampleBits`
  bool one_channel = false;          // colors are refused
};
/// The same from the bytes of a whole file; `name` is for messages.
Image decodeImage(std::string_view bytes, const std::filesystem::path& name, ImagePool& pool,
                  const ExpectedImage& expected = {});
/// The header, and the brightest sample as `readBrightestSample` gives it, from the bytes of a whole file.
ImageHeader parseImageHeader(std::string_view bytes, const std::filesystem::path& name);
int brightestSampleIn(std::string_view bytes, const std::filesystem::path& name);
/// The whole file, unless it is too large for an image.
std::string readImageBytes(const std::filesystem::path& file, int max_mb = kMaxImageFile_mb);
/// A gray PNG of 16 bits; one of 8 bits is widened without scaling.
Gray16Image readPng16(const std::filesystem::path& file);

/// Encodes an image as the bytes of a PNG file.
std::string encodePng(const RgbImage& image);
/// kFast trades a larger file for time.
enum class PngEffort { kFast, kSmall };
void writePng(const std::filesystem::path& file, const Image& image, PngEffort effort = PngEffort::kFast);
/// Encodes an image as the bytes of a JPEG file; `quality` is 1 to 100.
std::string encodeJpeg(const Image& image, int quality);
std::string encodeJpeg(const RgbImage& image, int quality);
void writePng16(const std::filesystem::path& file, const Gray16Image& image, PngEffort effort = PngEffort::kFast);
void writePngRgb(const std::filesystem::path& file, const RgbImage& image, PngEffort effort = PngEffort::kSmall);

}  // namespace motorcade
