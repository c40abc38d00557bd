#include "frontend/shape/census.hpp"

#include <algorithm>
#include <utility>

#include "frontend/image/byte_lanes.hpp"

namespace motorcade {
namespace {

constexpr int kHalf_px = 2, kSide_px = 2 * kHalf_px + 1;  // 24 pixels around one
constexpr int kBitsPerByte = 8;

/// A row of an image with its border repeated: columns from - kHalf_px ... from + width + kHalf_px - 1.
void copyWithBorder(const Image& image, int from, int width, int v, std::uint8_t* to) {
  const std::uint8_t* row = image.row(std::clamp(v, 0, image.height() - 1));
  const int first = from - kHalf_px, count = width + 2 * kHalf_px;
  const int inside = std::max(0, first), end = std::min(image.width(), first + count);
  std::copy(row + inside, row + end, to + (inside - first));
  std::fill(to, to + (inside - first), row[0]);
  std::fill(to + (end - first), to + count, row[image.width() - 1]);
}

}  // namespace

void Census::compute(const Image& image, const PixelWindow& window, int room) {
  room_ = static_cast<std::size_t>(room);
  const std::size_t lanes = static_cast<std::size_t>(window.width + kByteLanes - 1) / kByteLanes * kByteLanes;
  stride_ = lanes + 2 * room_;
  for (auto& plane : planes_) plane.resize(stride_ * window.height);
  texture_.resize(stride_ * window.height);
  stride_around_ = lanes + 2 * kHalf_px;
  around_.resize((window.height + 2 * kHalf_px) * stride_around_);
  for (int y = 0; y < window.height + 2 * kHalf_px; ++y)
    copyWithBorder(image, window.u0, window.width, window.v0 + y - kHalf_px, around_.data() + y * stride_around_);
  for (int v = 0; v < window.height; ++v)
    for (int u = 0; u < window.width; u += kByteLanes) computeLanes(u, v);
}

void Census::computeLanes(int u, int v) {
  const std::uint8_t* corner = around_.data() + v * stride_around_ + u;
  const Bytes middle = loadBytes(corner + kHalf_px * stride_around_ + kHalf_px);
  std::array<Bytes, kBytes> not_darker{};
  Bytes least = middle, most = middle;
  const auto compare = [&]<int kPixel>() {
    constexpr int kX = kPixel % kSide_px, kY = kPixel / kSide_px, kMiddle = kSide_px * kSide_px / 2;
    constexpr int kBit = kPixel < kMiddle ? kPixel : kPixel - 1;
    if constexpr (kPixel == kMiddle) return;
    const Bytes pixel = loadBytes(corner + kY * stride_around_ + kX);
    if constexpr (kX % 2 == 0 && kY % 2 == 0) least = lesser(least, pixel), most = greater(most, pixel);
    not_darker[kBit / kBitsPerByte] |=
        Bytes(greater(pixel, middle) == pixel) & allBytes(static_cast<std::uint8_t>(1 << kBit % kBitsPerByte));
  };
  [&]<int... kPixels>(std::integer_sequence<int, kPixels...>) { (compare.template operator()<kPixels>(), ...); }
  (std::make_integer_sequence<int, kSide_px * kSide_px>{});
  for (int byte = 0; byte < kBytes; ++byte) storeBytes(planes_[byte].data() + at(v) + u, ~not_darker[byte]);
  storeBytes(texture_.data() + at(v) + u, most - least);
}

}  // namespace motorcade
