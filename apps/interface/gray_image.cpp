#include "apps/interface/gray_image.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

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

std::ptrdiff_t strideOf(const Pair::Image& image) {
  return image.stride_bytes != 0 ? image.stride_bytes : image.width_px * bytesPerPixel(image.format);
}

void fillFrom16(const void* row, std::uint8_t* gray, int width) {
  const auto* bytes = static_cast<const std::uint8_t*>(row);
  for (int x = 0; x < width; ++x) {
    std::uint16_t value = 0;  // the caller's rows need not be aligned
    std::memcpy(&value, bytes + std::ptrdiff_t{2} * x, sizeof value);
    gray[x] = static_cast<std::uint8_t>(value >> 8);
  }
}

void fillFromColors(const void* row, std::uint8_t* gray, int width, int red, int blue) {
  const auto* bytes = static_cast<const std::uint8_t*>(row);
  for (int x = 0; x < width; ++x, bytes += 3) gray[x] = grayOf(bytes[red], bytes[1], bytes[blue]);
}

void fillRow(const void* row, Pair::Format format, std::uint8_t* gray, int width) {
  switch (format) {
    case Pair::Format::kGray8:
      std::memcpy(gray, row, static_cast<std::size_t>(width));
      break;
    case Pair::Format::kGray16:
      fillFrom16(row, gray, width);
      break;
    case Pair::Format::kRgb8:
      fillFromColors(row, gray, width, 0, 2);
      break;
    case Pair::Format::kBgr8:
      fillFromColors(row, gray, width, 2, 0);
      break;
  }
}

}  // namespace

const char* problemOf(const Pair::Image& image, const Camera& camera) {
  if (image.pixels == nullptr) return "an image has no pixels";
  if (image.width_px != camera.width_px || image.height_px != camera.height_px)
    return "an image is not of the camera's size";
  constexpr std::ptrdiff_t kMostStride_bytes = 1 << 24;
  const std::ptrdiff_t bytes = bytesPerPixel(image.format);
  if (bytes == 0) return "an image's format is none of those that there are";
  if (image.stride_bytes != 0 && image.stride_bytes < bytes * image.width_px)
    return "an image's stride is shorter than its rows";
  if (image.stride_bytes > kMostStride_bytes) return "an image's stride is above 2^24 bytes";
  return nullptr;
}

Image grayImage(const Pair::Image& image, ImagePool& pool) {
  Image gray = pool.acquire(image.width_px, image.height_px);
  const auto* row = static_cast<const std::uint8_t*>(image.pixels);
  for (int y = 0; y < image.height_px; ++y, row += strideOf(image))
    fillRow(row, image.format, gray.mutableRow(y), image.width_px);
  return gray;
}

}  // namespace motorcade
