#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.hpp"
#include "io/images/image_file.hpp"

/// The interface of `image_file` to each format, and functions that the formats share.
namespace motorcade {

// Files that are not read as images: what they are, and how to convert them.

/// A sentence with a command that converts the images of the file's folder to gray ones that are read.
std::string conversionOf(const std::filesystem::path& file);

/// Throws InputError that names the content of a file by its first bytes.
[[noreturn]] void failForeign(std::string_view bytes, const std::filesystem::path& file);

/// Reads one format from the bytes of a whole file; `file` is for messages. Throws InputError on a damaged image.
struct ImageCodec {
  ImageFormat format;
  bool (*recognizes)(std::string_view bytes);
  /// Parses the header alone. Throws on an unsupported kind of image.
  ImageHeader (*header)(std::string_view bytes, const std::filesystem::path& file);
  /// Decodes to 8-bit gray; `readImage` describes the treatment of samples with more bits.
  Image (*decode)(std::string_view bytes, const std::filesystem::path& file, ImagePool& pool, int sample_bits);
  /// The brightest sample of a file whose header declares 16 bits.
  int (*brightest)(std::string_view bytes, const std::filesystem::path& file);
};
const ImageCodec& pngCodec();
const ImageCodec& jpegCodec();
const ImageCodec& pgmCodec();

/// The size in a header, if an image may have it.
ImageSize checkedSize(std::uint64_t width, std::uint64_t height, const std::filesystem::path& file);
[[noreturn]] void failDamaged(const std::filesystem::path& file, const std::string& why);
/// Names a kind of image that is not read, "a CMYK JPEG", and a command that converts all of the file's folder.
[[noreturn]] void failUnsupported(const std::filesystem::path& file, const std::string& kind);

/// Pointers to the beginning of each row, for libraries that take them.
std::vector<std::uint8_t*> rowPointers(std::uint8_t* first, int height, std::size_t stride);

}  // namespace motorcade
