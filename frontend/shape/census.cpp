#include "frontend/shape/census.hpp"

#include <algorithm>
#include <utility>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "frontend/shape/census.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/pixel_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr int kHalf_px = 2, kSide_px = 2 * kHalf_px + 1;  // 24 pixels around one
constexpr int kBitsPerByte = 8;

using Planes = std::array<std::uint8_t*, Census::kBytes>;

/// kByteLanes pixels from column u on. `corner`: the first of the pixels around the first.
void transformLanes(const std::uint8_t* corner, std::size_t stride, int u, const Planes& planes,
                    std::uint8_t* texture) {
  const Bytes middle = load(corner + kHalf_px * stride + kHalf_px);
  std::array<Bytes, Census::kBytes> not_darker{};
  Bytes least = middle, most = middle;
  const auto compare = [&]<int kPixel>() HWY_ATTR {
    constexpr int kX = kPixel % kSide_px, kY = kPixel / kSide_px, kMiddle = kSide_px * kSide_px / 2;
    constexpr int kBit = kPixel < kMiddle ? kPixel : kPixel - 1;
    if constexpr (kPixel == kMiddle) return;
    const Bytes pixel = load(corner + kY * stride + kX);
    if constexpr (kX % 2 == 0 && kY % 2 == 0) least = lesser(least, pixel), most = greater(most, pixel);
    not_darker[kBit / kBitsPerByte] |= (greater(pixel, middle) == pixel).template as<std::uint8_t>() &
                                       static_cast<std::uint8_t>(1 << kBit % kBitsPerByte);
  };
  [&]<int... kPixels>(std::integer_sequence<int, kPixels...>) HWY_ATTR {
    (compare.template operator()<kPixels>(), ...);
  }
  (std::make_integer_sequence<int, kSide_px * kSide_px>{});
  for (int byte = 0; byte < Census::kBytes; ++byte) store(planes[byte] + u, ~not_darker[byte]);
  store(texture + u, most - least);
}

}  // namespace

void transformRow(const std::uint8_t* around, std::size_t stride, int width, const Planes& planes,
                  std::uint8_t* texture) {
  for (int u = 0; u < width; u += kByteLanes) transformLanes(around + u, stride, u, planes, texture);
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(transformRow);

namespace {

using HWY_NAMESPACE::kHalf_px;

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
  const std::size_t lanes = static_cast<std::size_t>(window.width + HWY_NAMESPACE::kByteLanes - 1) /
                            HWY_NAMESPACE::kByteLanes * HWY_NAMESPACE::kByteLanes;
  stride_ = lanes + 2 * room_;
  for (auto& plane : planes_) plane.resize(stride_ * window.height);
  texture_.resize(stride_ * window.height);
  stride_around_ = lanes + 2 * kHalf_px;
  around_.resize((window.height + 2 * kHalf_px) * stride_around_);
  for (int y = 0; y < window.height + 2 * kHalf_px; ++y)
    copyWithBorder(image, window.u0, window.width, window.v0 + y - kHalf_px, around_.data() + y * stride_around_);
  const auto transform = MOTORCADE_KERNEL(transformRow);
  for (int v = 0; v < window.height; ++v) {
    std::array<std::uint8_t*, kBytes> planes;
    for (int byte = 0; byte < kBytes; ++byte) planes[byte] = planes_[byte].data() + at(v);
    transform(around_.data() + v * stride_around_, stride_around_, window.width, planes, texture_.data() + at(v));
  }
}

}  // namespace motorcade
#endif
