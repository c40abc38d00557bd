#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "core/image.hpp"
#include "io/images/image_file.hpp"

/// Two ways from the bytes of a PNG to its pixels in gray. Where both give an image, it is the same.
namespace motorcade {

/// Decodes what cameras write: 8-bit gray or color or 16-bit gray, not interlaced, without a palette or a transparent
/// color; in less than half of libpng's time. `size` is the header's. Empty for other files and for damaged ones:
/// libpng is to decode them or to say what is wrong. See `usedSampleBits` for those of 16-bit samples.
///
/// A file that was damaged by chance is empty here: each part has a checksum. One that was made to, with right
/// checksums around a stream that has codes which zlib refuses, may give an image.
std::optional<Image> decodeCommonPng(std::string_view bytes, ImageSize size, ImagePool& pool,
                                     int sample_bits = kAllSampleBits);

/// Decodes any PNG, by libpng alone. Throws InputError, with libpng's words, on a damaged one.
Image decodeAnyPng(std::string_view bytes, const std::filesystem::path& file, ImagePool& pool,
                   int sample_bits = kAllSampleBits);

}  // namespace motorcade
