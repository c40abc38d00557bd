#include "frontend/shape/census.hpp"

#include <algorithm>

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

void Census::compute(const Image& image, const PixelWindow& window, bool mirrored, int room) {
  room_ = static_cast<std::size_t>(room);
  const std::size_t lanes = static_cast<std::size_t>(window.width + kByteLanes - 1) / kByteLanes * kByteLanes;
  stride_ = lanes + 2 * room_;
  for (auto& plane : planes_) plane.resize(stride_ * window.height);
  texture_.resize(stride_ * window.height);
  around_.resize(kSide_px * (lanes + 2 * kHalf_px));
  for (int v = 0; v < window.height; ++v) {
    computeRow(image, window, v);
    if (!mirrored) continue;
    for (auto& plane : planes_) std::reverse(plane.data() + at(v), plane.data() + at(v) + window.width);
  }
}

void Census::computeRow(const Image& image, const PixelWindow& window, int v) {
  const std::size_t stride = around_.size() / kSide_px;
  for (int y = 0; y < kSide_px; ++y)
    copyWithBorder(image, window.u0, window.width, window.v0 + v + y - kHalf_px, around_.data() + y * stride);
  for (int u = 0; u < window.width; u += kByteLanes) {
    const std::uint8_t* corner = around_.data() + u;
    const Bytes middle = loadBytes(corner + kHalf_px * stride + kHalf_px);
    std::array<Bytes, kBytes> bits{};
    Bytes least = middle, most = middle;
    for (int y = 0, bit = 0; y < kSide_px; ++y)
      for (int x = 0; x < kSide_px; ++x) {
        const Bytes pixel = loadBytes(corner + y * stride + x);
        if (x % 2 == 0 && y % 2 == 0) least = lesser(least, pixel), most = greater(most, pixel);
        if (x == kHalf_px && y == kHalf_px) continue;
        bits[bit / kBitsPerByte] |=
            Bytes(pixel < middle) & allBytes(static_cast<std::uint8_t>(1 << bit % kBitsPerByte));
        ++bit;
      }
    for (int byte = 0; byte < kBytes; ++byte) storeBytes(planes_[byte].data() + at(v) + u, bits[byte]);
    storeBytes(texture_.data() + at(v) + u, most - least);
  }
}

}  // namespace motorcade
