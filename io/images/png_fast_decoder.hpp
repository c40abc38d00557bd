#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "core/image.hpp"
#include "io/images/image_file.hpp"

/// Two ways from the bytes of a PNG to its pixels in gray. Where both give an image, it is the same.
namespace motorcade {

/// A row of a PNG as it was packed: each byte less the prediction from its neighbors, by the filter that the row names.
struct FilteredRow {
  const std::uint8_t* bytes;
  const std::uint8_t* above;  // the row before, without its filter; of the first row: zeros
  std::size_t count;          // bytes, whole pixels
};

/// Undoes a filter on a row of pixels of 1 to 4 bytes. `to` may be the row itself. False when the filter is unknown.
bool removeFilter(int filter, int pixel_bytes, FilteredRow row, std::uint8_t* to);

/// Decodes what cameras write in less than half of libpng's time: 8-bit gray or color or 16-bit gray, not interlaced,
/// without a palette or a transparent color. `size` is the header's. Empty for other files and for damaged ones: libpng
/// decodes them or says what is wrong. See `usedSampleBits` for 16-bit samples.
///
/// A file that was damaged by chance gives an empty result, as each part has a checksum. A file that was damaged on
/// purpose may give an image: it has right checksums, but codes that zlib refuses.
std::optional<Image> decodeCommonPng(std::string_view bytes, ImageSize size, ImagePool& pool,
                                     int sample_bits = kAllSampleBits);

/// Decodes any PNG, by libpng alone. Throws InputError, with libpng's words, on a damaged one.
Image decodeAnyPng(std::string_view bytes, const std::filesystem::path& file, ImagePool& pool,
                   int sample_bits = kAllSampleBits);

}  // namespace motorcade
