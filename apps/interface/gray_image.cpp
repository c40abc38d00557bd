#include "apps/interface/gray_image.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "io/images/sample_bits.hpp"

namespace motorcade {
namespace {

std::ptrdiff_t bytesPerPixel(Pair::Format format) {
  switch (format) {
    case Pair::Format::kGray8:
      return 1;
    case Pair::Format::kGray16:
      return 2;
    case Pair::Format::kRgb8:
    case Pair::Format::kBgr8:
      return 3;
  }
  return 0;
}

/// The caller's rows need not be aligned.
std::uint16_t sampleAt(const void* row, int x) {
  std::uint16_t value = 0;
  std::memcpy(&value, static_cast<const std::uint8_t*>(row) + std::ptrdiff_t{2} * x, sizeof value);
  return value;
}

void fillFrom16(const void* row, std::uint8_t* gray, int width, int sample_bits) {
  for (int x = 0; x < width; ++x) gray[x] = upperBits(sampleAt(row, x), sample_bits);
}

void fillFromColors(const void* row, std::uint8_t* gray, int width, int red, int blue) {
  const auto* bytes = static_cast<const std::uint8_t*>(row);
  for (int x = 0; x < width; ++x, bytes += 3) gray[x] = grayOf(bytes[red], bytes[1], bytes[blue]);
}

void fillRow(const void* row, Pair::Format format, int sample_bits, std::uint8_t* gray, int width) {
  switch (format) {
    case Pair::Format::kGray8:
      std::memcpy(gray, row, static_cast<std::size_t>(width));
      break;
    case Pair::Format::kGray16:
      fillFrom16(row, gray, width, sample_bits);
      break;
    case Pair::Format::kRgb8:
      fillFromColors(row, gray, width, 0, 2);
      break;
    case Pair::Format::kBgr8:
      fillFromColors(row, gray, width, 2, 0);
      break;
  }
}

/// 0 unless the samples have 16 bits.
int brightestOf(const Pair::Image& image) {
  if (image.format != Pair::Format::kGray16) return 0;
  std::uint16_t brightest = 0;
  const auto* row = static_cast<const std::uint8_t*>(image.pixels);
  for (int y = 0; y < image.height_px; ++y, row += strideOf(image))
    for (int x = 0; x < image.width_px; ++x) brightest = std::max(brightest, sampleAt(row, x));
  return brightest;
}

}  // namespace

/// Samples that eight bits hold may be those of a dark pair of a camera with more bits: a later pair will tell.
int SampleBits::of(const Pair& pair) {
  constexpr int kDark = 8;
  if (pair.left.format != Pair::Format::kGray16 && pair.right.format != Pair::Format::kGray16) return kAllSampleBits;
  if (const int decided = decided_.load(std::memory_order_relaxed); decided != 0) return decided;
  brightest_ = std::max(brightestOf(pair.left), brightestOf(pair.right));
  const int bits = usedSampleBits(0, brightest_);
  if (bits > kDark) decided_.store(bits, std::memory_order_release);
  return bits;
}

std::optional<std::string> SampleBits::news() {
  const int decided = decided_.load(std::memory_order_acquire);
  if (told_ || decided == 0) return std::nullopt;
  told_ = true;
  return "images of 16 bits, taken as " + std::to_string(decided) +
         ": the brightest sample of the first pair that is not dark is " + std::to_string(brightest_);
}

std::ptrdiff_t strideOf(const Pair::Image& image) {
  return image.stride_bytes != 0 ? image.stride_bytes : image.width_px * bytesPerPixel(image.format);
}

const char* problemOf(const Pair::Image& image, const Camera& camera) {
  if (image.pixels == nullptr) return "an image has no pixels";
  if (image.width_px != camera.width_px || image.height_px != camera.height_px)
    return "an image is not of the camera's size";
  const std::ptrdiff_t bytes = bytesPerPixel(image.format);
  if (bytes == 0) return "an image's format is none of those that there are";
  if (image.stride_bytes != 0 && image.stride_bytes < bytes * image.width_px)
    return "an image's stride is shorter than its rows";
  if (image.stride_bytes > kMostStride_bytes) return "an image's stride is above 2^24 bytes";
  return nullptr;
}

Image grayImage(const Pair::Image& image, int sample_bits, ImagePool& pool) {
  Image gray = pool.acquire(image.width_px, image.height_px);
  const auto* row = static_cast<const std::uint8_t*>(image.pixels);
  for (int y = 0; y < image.height_px; ++y, row += strideOf(image))
    fillRow(row, image.format, sample_bits, gray.mutableRow(y), image.width_px);
  return gray;
}

}  // namespace motorcade
