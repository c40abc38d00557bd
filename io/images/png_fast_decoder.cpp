#include "io/images/png_fast_decoder.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <libdeflate.h>

#include "io/images/png_chunks.hpp"

namespace motorcade {
namespace {

/// The filters of the PNG specification (2nd edition, section 9.2), with its numbers.
enum Filter { kNone, kSub, kUp, kAverage, kPaeth };

/// Returns the one of three neighbors that is closest to left + above - corner (section 9.4). It has no branches, as
/// noise would make them unpredictable.
int paeth(int left, int above, int corner) {
  const int right = left - corner, down = above - corner;
  const int from_left = std::abs(down), from_above = std::abs(right), from_corner = std::abs(right + down);
  const int side = from_left <= from_above ? left : above;
  return std::min(from_left, from_above) <= from_corner ? side : corner;
}

/// Adds the result of `predict(left, above, corner)`. The row comes by value, so that the compiler knows that writing
/// does not change its pointers.
template <int kChannels, class Predict>
void addPrediction(FilteredRow row, std::uint8_t* to, const Predict& predict) {
  std::array<std::uint8_t, kChannels> left{}, corner{};
  for (std::size_t x = 0; x < row.count; x += kChannels) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      const std::uint8_t above = row.above[x + c];
      left[c] = static_cast<std::uint8_t>(row.bytes[x + c] + predict(left[c], above, corner[c]));
      corner[c] = above;
      to[x + c] = left[c];
    }
  }
}

void addRowAbove(FilteredRow row, std::uint8_t* to) {
  for (std::size_t x = 0; x < row.count; ++x) to[x] = static_cast<std::uint8_t>(row.bytes[x] + row.above[x]);
}

template <int kChannels>
bool removeFilterOf(int filter, FilteredRow row, std::uint8_t* to) {
  switch (filter) {
    case kNone:
      std::memmove(to, row.bytes, row.count);
      return true;
    case kSub:
      addPrediction<kChannels>(row, to, [](int left, int, int) { return left; });
      return true;
    case kUp:
      addRowAbove(row, to);
      return true;
    case kAverage:
      addPrediction<kChannels>(row, to, [](int left, int above, int) { return (left + above) >> 1; });
      return true;
    case kPaeth:
      addPrediction<kChannels>(row, to, paeth);
      return true;
    default:
      return false;
  }
}

}  // namespace

bool removeFilter(int filter, int pixel_bytes, FilteredRow row, std::uint8_t* to) {
  switch (pixel_bytes) {
    case 1:
      return removeFilterOf<1>(filter, row, to);
    case 2:
      return removeFilterOf<2>(filter, row, to);
    case 3:
      return removeFilterOf<3>(filter, row, to);
    case 4:
      return removeFilterOf<4>(filter, row, to);
    default:
      assert(false);
      return false;
  }
}

namespace {

/// Largest image that is unpacked here. Larger ones are rare, and their work space would stay in the pool.
constexpr std::size_t kMostUnpacked_bytes = std::size_t{1} << 26;

/// Memory in which the pixels are unpacked. The sizes of its parts depend only on the image's size, so that the pool
/// holds the same memory for each image of a drive.
class WorkSpace {
 public:
  WorkSpace(ImageSize size, int pixel_bytes, ImagePool& pool)
      : row_bytes_(static_cast<std::size_t>(size.width) * pixel_bytes),
        unpacked_bytes_((1 + row_bytes_) * size.height),
        // Noise grows by a few bytes per block of deflate; no encoder packs worse.
        most_packed_bytes_(unpacked_bytes_ + unpacked_bytes_ / 16 + 1024) {
    if (unpacked_bytes_ <= kMostUnpacked_bytes)
      memory_ = pool.acquire(static_cast<int>(row_bytes_ + unpacked_bytes_ + most_packed_bytes_), 1);
  }
  WorkSpace(const WorkSpace&) = delete;
  WorkSpace& operator=(const WorkSpace&) = delete;

  bool holds(const CommonPng& png) const { return !memory_.empty() && png.packed_bytes <= most_packed_bytes_; }
  std::size_t rowBytes() const { return row_bytes_; }
  std::size_t unpackedBytes() const { return unpacked_bytes_; }

  /// The row above the first one.
  std::uint8_t* zeros() { return memory_.mutableRow(0); }
  /// Rows, each after the number of its filter.
  std::uint8_t* unpacked() { return zeros() + row_bytes_; }
  std::uint8_t* packed() { return unpacked() + unpacked_bytes_; }

 private:
  std::size_t row_bytes_, unpacked_bytes_, most_packed_bytes_;
  Image memory_;
};

/// True when the window that the stream claims is large enough for any distance within it. zlib refuses larger
/// distances, libdeflate does not.
bool windowSuffices(std::uint8_t first_byte, std::size_t unpacked_bytes) {
  constexpr std::size_t kLargest_bytes = 32768;
  const std::size_t window_bytes = std::size_t{256} << (first_byte >> 4);
  return window_bytes >= std::min(kLargest_bytes, unpacked_bytes);
}

/// Unpacks the whole stream. Fails unless it holds exactly the bytes of the image and nothing follows.
bool unpack(const CommonPng& png, WorkSpace& space) {
  joinImageChunks(png, space.packed());
  if (png.packed_bytes == 0 || !windowSuffices(*space.packed(), space.unpackedBytes())) return false;
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!decompressor) return false;
  std::size_t read_bytes = 0;
  const auto result = libdeflate_zlib_decompress_ex(decompressor.get(), space.packed(), png.packed_bytes,
                                                    space.unpacked(), space.unpackedBytes(), &read_bytes, nullptr);
  return result == LIBDEFLATE_SUCCESS && read_bytes == png.packed_bytes;
}

/// Leaves alpha out, as libpng does when asked to strip it.
void convertToGray(const std::uint8_t* row, int pixel_bytes, int width, std::uint8_t* gray) {
  if (pixel_bytes == 2) {
    for (int x = 0; x < width; ++x) gray[x] = row[2 * x];
  } else {
    for (int x = 0; x < width; ++x, row += pixel_bytes) gray[x] = grayOf(row[0], row[1], row[2]);
  }
}

void scaleToGray(const std::uint8_t* row, int pixel_bytes, int width, int sample_bits, std::uint8_t* gray) {
  for (int x = 0; x < width; ++x, row += pixel_bytes)
    gray[x] = upperBits(static_cast<unsigned>(row[0]) << 8 | row[1], sample_bits);
}

/// Undoes the filters and fills the image. Gray rows need no buffer between. False when a row names an unknown filter.
bool removeFilters(WorkSpace& space, const CommonPng& png, int sample_bits, Image& image) {
  std::memset(space.zeros(), 0, space.rowBytes());
  const std::uint8_t* above = space.zeros();
  std::uint8_t* row = space.unpacked();
  for (int y = 0; y < image.height(); ++y, row += 1 + space.rowBytes()) {
    std::uint8_t* const to = png.pixel_bytes == 1 ? image.mutableRow(y) : row + 1;
    if (!removeFilter(*row, png.pixel_bytes, {row + 1, above, space.rowBytes()}, to)) return false;
    if (png.deep) {
      scaleToGray(to, png.pixel_bytes, image.width(), sample_bits, image.mutableRow(y));
    } else if (png.pixel_bytes > 1) {
      convertToGray(to, png.pixel_bytes, image.width(), image.mutableRow(y));
    }
    above = to;
  }
  return true;
}

}  // namespace

std::optional<Image> decodeCommonPng(std::string_view bytes, ImageSize size, ImagePool& pool, int sample_bits) {
  const auto png = findCommonPng(bytes);
  if (!png) return std::nullopt;
  WorkSpace space(size, png->pixel_bytes, pool);
  if (!space.holds(*png) || !unpack(*png, space)) return std::nullopt;
  Image image = pool.acquire(size.width, size.height);
  if (!removeFilters(space, *png, sample_bits, image)) return std::nullopt;
  return image;
}

}  // namespace motorcade
