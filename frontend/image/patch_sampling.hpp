#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "core/image.hpp"
#include "frontend/image/word_lanes.hpp"

/// Samples an image between its pixels, a row of sixteen at a time, in integers of 1/64 gray level.
namespace motorcade {

inline constexpr int kSampleBits = 6, kSampleLevels = 1 << kSampleBits;  // of a sample per gray level, and per pixel
inline constexpr int kRowLevels = 1 << 15;                               // per pixel, as `scaled` takes fractions
inline constexpr int kBlockRows = 16, kBlockStride = 48;  // of the largest rectangle that may lie across a border
inline constexpr int kBlockMargin = 32;                   // bytes that may be read past a block

/// True from the middle of the first pixel to that of the last one.
inline bool inside(const Image& image, float u_px, float v_px) {
  return u_px >= 0 && v_px >= 0 && u_px <= static_cast<float>(image.width() - 1) &&
         v_px <= static_cast<float>(image.height() - 1);
}

/// Prefetches the pixels of a patch around (u, v) into the cache.
inline void prefetchPatch(const Image& image, float u_px, float v_px, int window_px) {
  const int half = window_px / 2 + 1, u = static_cast<int>(u_px), v = static_cast<int>(v_px);
  const int left = std::clamp(u - half, 0, image.width() - 1), right = std::clamp(u + half, 0, image.width() - 1);
  const int bottom = std::min(v + half + 1, image.height() - 1);
  for (int y = std::max(v - half, 0); y <= bottom; ++y) {
    __builtin_prefetch(image.row(y) + left);
    __builtin_prefetch(image.row(y) + right);
    asm volatile("");  // or GCC takes the loop to be without effect
  }
}

/// Mask of ones inside the window, zeros to its right.
inline Words windowMask(int window_px) {
  constexpr Words kColumns{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  return kColumns < allWords(window_px);  // minus one: all bits set
}

/// Position of a column in 1/64 px, the resolution of sampling between columns.
struct ColumnPosition {
  explicit ColumnPosition(float px) {
    const float position = std::floor(px * kSampleLevels + 0.5F);
    pixel = static_cast<int>(position) >> kSampleBits;
    fraction = static_cast<int>(position) & (kSampleLevels - 1);
    px_ = position / kSampleLevels;
  }
  float px() const { return px_; }
  int pixel, fraction;

 private:
  float px_;
};

/// Position of a row in 2^-15 px.
struct RowPosition {
  explicit RowPosition(float px) : pixel(static_cast<int>(std::floor(px))) {
    fraction = std::min(static_cast<int>((px - static_cast<float>(pixel)) * kRowLevels), kRowLevels - 1);
  }
  int pixel, fraction;
};

inline Words betweenRows(const Words& upper, const Words& lower, const Words& fraction) {
  return upper + scaled(lower - upper, fraction);
}

/// A rectangle of pixels with room to read 24 beyond its right edge. It lies in the image itself, or is a copy where
/// the image's border is repeated.
class Block {
 public:
  Block(const Image& image, int x, int y, int columns, int rows) {
    if (x >= 0 && y >= 0 && x + columns <= image.width() && y + rows <= image.height()) {
      origin_ = image.row(y) + x;
      stride_ = image.stride();
      return;
    }
    assert(rows <= kBlockRows && columns <= kBlockStride);
    copy(image, x, y, rows);
    origin_ = copy_.data();
    stride_ = kBlockStride;
  }
  const std::uint8_t* row(int r) const { return origin_ + r * stride_; }

 private:
  [[gnu::noinline]] void copy(const Image& image, int x, int y, int rows) {
    // Columns of the block where the image begins and ends.
    const int left = std::clamp(-x, 0, kBlockStride), right = std::clamp(image.width() - x, left, kBlockStride);
    for (int r = 0; r < rows; ++r) {
      const std::uint8_t* row = image.row(std::clamp(y + r, 0, image.height() - 1));
      std::uint8_t* out = copy_.data() + r * kBlockStride;
      if (right - left == kBlockStride) {  // most blocks lie across the upper or lower border alone
        std::memcpy(out, row + x, kBlockStride);
        continue;
      }
      std::memset(out, row[0], left);
      std::memcpy(out + left, row + x + left, right - left);
      std::memset(out + right, row[image.width() - 1], kBlockStride - right);
    }
    std::memset(copy_.data() + rows * kBlockStride, 0, kBlockMargin);
  }

  const std::uint8_t* origin_;
  std::ptrdiff_t stride_;
  std::array<std::uint8_t, kBlockRows * kBlockStride + kBlockMargin> copy_;  // not filled unless needed
};

/// Sixteen columns to sample. For each it keeps the pixels to its left and right, counted from the first pixel of its
/// group of eight columns, and their weights.
class SampleColumns {
 public:
  /// Weights of the pixels to the left and right of a column that lies `fraction` / 64 px between them, in one word.
  static std::int16_t weightsOf(int fraction) {
    return static_cast<std::int16_t>(fraction << 8 | (kSampleLevels - fraction));
  }
  /// Columns one pixel apart, the first of them to the right of the row's first pixel. Samples without weight are zero.
  explicit SampleColumns(const Words& weights)
      : second_group_(kWordLanes / 2), pixels_(kNextTo), weights_(Bytes(weights)) {}

  /// Columns at any positions from left to right. Those of a group of eight lie within 15 px, all between 0 and
  /// `last_px`, which is inside the image.
  SampleColumns(const std::array<float, kWordLanes>& positions_px, int last_px) {
    for (int i = 0; i < kWordLanes; ++i) {
      // NOLINTNEXTLINE(bugprone-incorrect-roundings): positions are not negative
      const int position = static_cast<int>(positions_px[i] * kSampleLevels + 0.5F);
      const int pixel = std::min(position >> kSampleBits, last_px - 1), right_weight = position - pixel * kSampleLevels;
      if (i == 0) first_group_ = pixel;
      if (i == kWordLanes / 2) second_group_ = pixel;
      const int column = pixel - (i < kWordLanes / 2 ? first_group_ : second_group_);
      pixels_[2 * i] = static_cast<std::uint8_t>(column);
      pixels_[2 * i + 1] = static_cast<std::uint8_t>(column + 1);
      weights_[2 * i] = static_cast<std::uint8_t>(kSampleLevels - right_weight);
      weights_[2 * i + 1] = static_cast<std::uint8_t>(right_weight);
    }
  }

  Words operator()(const std::uint8_t* row) const {
    const std::uint8_t *p = row + first_group_, *q = row + second_group_;
#ifdef __AVX2__
    const __m256i both =
        _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p))),
                                _mm_loadu_si128(reinterpret_cast<const __m128i*>(q)), 1);
    return Words(_mm256_maddubs_epi16(_mm256_shuffle_epi8(both, __m256i(pixels_)), __m256i(weights_)));
#else
    Words samples;
    for (int i = 0; i < kWordLanes; ++i) {
      const std::uint8_t* group = i < kWordLanes / 2 ? p : q;
      samples[i] = static_cast<std::int16_t>(group[pixels_[2 * i]] * weights_[2 * i] +
                                             group[pixels_[2 * i + 1]] * weights_[2 * i + 1]);
    }
    return samples;
#endif
  }

 private:
  using Bytes = std::uint8_t __attribute__((vector_size(2 * kWordLanes)));
  static constexpr Bytes kNextTo{0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8,
                                 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8};
  int first_group_ = 0, second_group_ = 0;
  Bytes pixels_, weights_;
};

}  // namespace motorcade
