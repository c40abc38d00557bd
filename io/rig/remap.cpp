#include "io/rig/remap.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "io/rig/remap.cpp"
#include <hwy/foreach_target.h>

#include "core/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {

constexpr int kOne = 1 << Remap::kFractionBits;
static_assert(std::endian::native == std::endian::little);  // the left one of two pixels lies in the low byte
constexpr int kBlock = 32;                                  // pixels at a time: arrays of this length become vectors

/// Weighs four neighbors for each pixel of a block. Only the gathering goes pixel by pixel; the two neighbors in a row
/// are taken at once.
void weighBlock(const std::uint8_t* raw, int stride, const Remap::Sources& from, std::uint8_t* out) {
  std::array<std::int32_t, kBlock> offsets;
  for (int i = 0; i < kBlock; ++i) offsets[i] = from.y[i] * stride + from.x[i];
  std::array<std::uint16_t, kBlock> upper, lower;
  for (int i = 0; i < kBlock; ++i) {
    std::memcpy(&upper[i], raw + offsets[i], 2);
    std::memcpy(&lower[i], raw + offsets[i] + stride, 2);
  }
  // The sums of a row fit into 16 bits, of which a vector holds twice as many as of 32.
  std::array<std::uint16_t, kBlock> above, below;
  for (int i = 0; i < kBlock; ++i) {
    const auto to_right = static_cast<std::uint16_t>(from.right[i]);
    const auto to_left = static_cast<std::uint16_t>(kOne - to_right);
    above[i] = static_cast<std::uint16_t>((upper[i] & 0xFF) * to_left + (upper[i] >> 8) * to_right);
    below[i] = static_cast<std::uint16_t>((lower[i] & 0xFF) * to_left + (lower[i] >> 8) * to_right);
  }
  for (int i = 0; i < kBlock; ++i) {
    const int sum = above[i] * (kOne - from.down[i]) + below[i] * from.down[i];
    out[i] = static_cast<std::uint8_t>((sum + kOne * kOne / 2) >> (2 * Remap::kFractionBits));
  }
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(weighBlock);

namespace {

using HWY_NAMESPACE::kBlock, HWY_NAMESPACE::kOne;

/// A position along one axis: the first of two pixels, and the share of the second in 64ths.
struct Place {
  std::int16_t first;
  std::uint8_t share;
  bool inside;  // of the image, else the nearest place in it
};

Place placed(double position_px, int size) {
  const int last = kOne * (size - 1);
  const double exact = std::floor(kOne * position_px + 0.5);
  const auto fixed = static_cast<int>(std::clamp<double>(exact, 0, last));
  const int first = std::min(fixed / kOne, size - 2);
  return {static_cast<std::int16_t>(first), static_cast<std::uint8_t>(fixed - kOne * first), exact == fixed};
}

}  // namespace

Remap::Remap(const LensCamera& raw, const Eigen::Matrix3d& R, const StereoCamera& target, ImageSize raw_size)
    : raw_size_(raw_size), size_{target.width_px, target.height_px} {
  const std::size_t pixels = static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height);
  // A whole block is read at a row's end; behind the last row its content does not matter.
  x_.resize(pixels + kBlock);
  y_.resize(pixels + kBlock);
  right_.resize(pixels + kBlock);
  down_.resize(pixels + kBlock);
  const LensModel lens(raw);
  for (int v = 0; v < size_.height; ++v) fillRow(v, lens, R, target);
}

void Remap::fillRow(int v, const LensModel& lens, const Eigen::Matrix3d& R, const StereoCamera& target) {
  const std::size_t row = static_cast<std::size_t>(v) * size_.width;
  const double y = (v - target.cy_px) / target.fy_px;
  for (int u = 0; u < size_.width; ++u) {
    const double x = (u - target.cx_px) / target.fx_px;
    const Eigen::Vector3d ray(R(0, 0) * x + R(1, 0) * y + R(2, 0), R(0, 1) * x + R(1, 1) * y + R(2, 1),
                              R(0, 2) * x + R(1, 2) * y + R(2, 2));
    const Eigen::Vector2d at_px = lens.project(ray).value_or(Eigen::Vector2d(-1, -1));
    const Place across = placed(at_px.x(), raw_size_.width), along = placed(at_px.y(), raw_size_.height);
    x_[row + u] = across.first;
    y_[row + u] = along.first;
    right_[row + u] = across.share;
    down_[row + u] = along.share;
    outside_ += across.inside && along.inside ? 0 : 1;
  }
}

Image Remap::operator()(const Image& raw, ImagePool& pool) const {
  assert(raw.width() == raw_size_.width && raw.height() == raw_size_.height);
  Image result = pool.acquire(size_.width, size_.height);
  const auto weigh = MOTORCADE_KERNEL(weighBlock);
  std::array<std::uint8_t, kBlock> last;
  for (int v = 0; v < size_.height; ++v) {
    const std::size_t row = static_cast<std::size_t>(v) * size_.width;
    std::uint8_t* const out = result.mutableRow(v);
    for (int u = 0; u < size_.width; u += kBlock) {
      const std::size_t at = row + u;
      const int count = std::min(kBlock, size_.width - u);
      weigh(raw.data(), raw.stride(), {&x_[at], &y_[at], &right_[at], &down_[at]},
            count == kBlock ? out + u : last.data());
      if (count < kBlock) std::copy_n(last.begin(), count, out + u);
    }
  }
  return result;
}

double Remap::shareOutside() const { return static_cast<double>(outside_) / static_cast<double>(x_.size() - kBlock); }

Eigen::Vector2d Remap::source_px(int u, int v) const {
  const std::size_t at = static_cast<std::size_t>(v) * size_.width + u;
  constexpr double kUnit_px = 1.0 / kOne;
  return {x_[at] + kUnit_px * right_[at], y_[at] + kUnit_px * down_[at]};
}

}  // namespace motorcade
#endif
