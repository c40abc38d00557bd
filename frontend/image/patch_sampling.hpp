#if defined(MOTORCADE_PATCH_SAMPLING) == defined(HWY_TARGET_TOGGLE)
#ifdef MOTORCADE_PATCH_SAMPLING
#undef MOTORCADE_PATCH_SAMPLING
#else
#define MOTORCADE_PATCH_SAMPLING
#endif

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "core/image.hpp"
#include "frontend/image/pixel_lanes.hpp"

HWY_BEFORE_NAMESPACE();
/// Samples an image between its pixels, a row of sixteen at a time, in integers of 1/64 gray level.
namespace motorcade::HWY_NAMESPACE {

inline constexpr int kSampleBits = 6, kSampleLevels = 1 << kSampleBits;  // of a sample per gray level, and per pixel
inline constexpr int kRowLevels = 1 << 15;                               // per pixel, as `scaled` takes fractions
inline constexpr int kBlockRows = 16, kBlockStride = 48;  // of the largest rectangle that may lie across a border
inline constexpr int kBlockMargin = 32;                   // bytes that may be read past a block

/// True from the middle of the first pixel to that of the last one.
inline bool inside(const Image& image, float u_px, float v_px) {
  return u_px >= 0 && v_px >= 0 && u_px <= static_cast<float>(image.width() - 1) &&
         v_px <= static_cast<float>(image.height() - 1);
}

/// Mask of ones inside the window, zeros to its right.
inline Words windowMask(int window_px) {
  return wordNumbers() < allWords(window_px);  // minus one: all bits set
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
  explicit SampleColumns(const Words& weights) : pixels_(load(kNextTo)), weights_(weights) {}

  /// Columns at any positions from left to right. Those of a group of eight lie within 15 px, all between 0 and
  /// `last_px`, which is inside the image.
  SampleColumns(const std::array<float, kWordLanes>& positions_px, int last_px) : are_neighbors_(false) {
    std::array<std::uint8_t, kByteLanes> pixels;
    std::array<std::int16_t, kWordLanes> weights;
    for (int i = 0; i < kWordLanes; ++i) {
      // NOLINTNEXTLINE(bugprone-incorrect-roundings): positions are not negative
      const int position = static_cast<int>(positions_px[i] * kSampleLevels + 0.5F);
      const int pixel = std::min(position >> kSampleBits, last_px - 1);
      if (i == 0) first_group_ = pixel;
      if (i == kGroup) second_group_ = pixel;
      const int column = pixel - (i < kGroup ? first_group_ : second_group_);
      pixels[2 * i] = static_cast<std::uint8_t>(column);
      pixels[2 * i + 1] = static_cast<std::uint8_t>(column + 1);
      weights[i] = weightsOf(position - pixel * kSampleLevels);
    }
    pixels_ = load(pixels.data()), weights_ = load(weights.data());
  }

  HWY_INLINE Words operator()(const std::uint8_t* row) const {
    const std::uint8_t *p = row + first_group_, *q = row + second_group_;
#if MOTORCADE_SSE4
    return weighedPixels(p, q, pixels_, weights_);
#else
    const Words left = weights_ & 0xFF, right = weights_ >> 8;
    if (are_neighbors_) return wordPixels(p) * left + wordPixels(p + 1) * right;
    Words pixels_left, pixels_right;
    for (int i = 0; i < kWordLanes; ++i) {
      const std::uint8_t* const pixel = (i < kGroup ? p : q) + pixels_[2 * i];
      pixels_left.set(i, pixel[0]), pixels_right.set(i, pixel[1]);
    }
    return pixels_left * left + pixels_right * right;
#endif
  }

 private:
  static constexpr int kGroup = kWordLanes / 2;
  static constexpr std::uint8_t kNextTo[]{0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8,
                                          0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8};
  int first_group_ = 0, second_group_ = kGroup;
  bool are_neighbors_ = true;
  Bytes pixels_;
  Words weights_;
};

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
