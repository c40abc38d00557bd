#include "io/stream/stereo_packing.hpp"

#include <cstddef>
#include <cstring>
#include <string>

#include "io/files/errors.hpp"
#include "io/images/image_codec.hpp"
#include "io/images/sample_bits.hpp"

namespace motorcade {
namespace {

/// The same part of every row of a picture.
struct PictureView {
  const std::uint8_t* first;
  std::size_t stride;
};

void fillFromLittleEndian(const std::uint8_t* samples, std::uint8_t* gray, int width, int bits) {
  for (int x = 0; x < width; ++x) gray[x] = upperBits(samples[2 * x] | unsigned{samples[2 * x + 1]} << 8, bits);
}

Image grayOf(const PictureView& view, ImageSize size, int bits, ImagePool& pool) {
  Image gray = pool.acquire(size.width, size.height);
  const std::uint8_t* row = view.first;
  for (int y = 0; y < size.height; ++y, row += view.stride) {
    if (bits > 8)
      fillFromLittleEndian(row, gray.mutableRow(y), size.width, bits);
    else
      std::memcpy(gray.mutableRow(y), row, static_cast<std::size_t>(size.width));
  }
  return gray;
}

}  // namespace

ImageSize unpackedSize(const Y4mHeader& header, StereoPacking packing, const std::string& name) {
  const bool beside = packing == StereoPacking::kSideBySide;
  if ((beside ? header.width : header.height) % 2 != 0)
    throw InputError(name + ": the pictures are " + std::to_string(header.width) + "x" + std::to_string(header.height) +
                     ", an odd " + (beside ? "width" : "height") + " that two images cannot share; is it --" +
                     (beside ? "over-under" : "side-by-side") + "? Else cut a " + (beside ? "column" : "row") +
                     " off, as by ffmpeg's crop filter");
  return checkedSize(static_cast<std::uint64_t>(beside ? header.width / 2 : header.width),
                     static_cast<std::uint64_t>(beside ? header.height : header.height / 2), name);
}

ImagePair unpacked(std::span<const std::uint8_t> luma, int bits, StereoPacking packing, ImageSize size,
                   ImagePool& pool) {
  const bool beside = packing == StereoPacking::kSideBySide;
  const std::size_t row_bytes = static_cast<std::size_t>(size.width) * (bits > 8 ? 2 : 1);
  const std::size_t stride = beside ? 2 * row_bytes : row_bytes;
  const std::size_t right = beside ? row_bytes : row_bytes * static_cast<std::size_t>(size.height);
  return {grayOf({luma.data(), stride}, size, bits, pool), grayOf({luma.data() + right, stride}, size, bits, pool)};
}

}  // namespace motorcade
