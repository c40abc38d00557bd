#include "io/images/png_chunks.hpp"

#include <algorithm>
#include <cstring>

#include <libdeflate.h>

namespace motorcade {
namespace {

constexpr std::size_t kLengthAndName_bytes = 8, kAroundData_bytes = 12;
/// Largest ancillary chunk that is skipped here. Larger ones are left to libpng, which may refuse them.
constexpr std::size_t kMostToSkip_bytes = 1'000'000;

/// Zero for a palette, and where there is none such.
int channelsOf(char color) {
  switch (color) {
    case 0:
      return 1;  // gray
    case 2:
      return 3;  // RGB
    case 4:
      return 2;  // gray and alpha
    case 6:
      return 4;  // RGB and alpha
    default:
      return 0;
  }
}

/// Reads the size and depth of a pixel from the header; `pixel_bytes` is 0 unless the header is that of a common PNG.
CommonPng commonPngOf(const PngChunk& header) {
  constexpr std::size_t kHeader_bytes = 13, kBits = 8, kColor = 9, kInterlace = 12;
  if (header.name != "IHDR" || header.data.size() != kHeader_bytes) return {};
  const bool packed_as_all_are = header.data.substr(kColor + 1, 2) == std::string_view("\0\0", 2);
  if (!packed_as_all_are || header.data[kInterlace] != 0) return {};
  const int channels = channelsOf(header.data[kColor]);
  if (header.data[kBits] == 8) return {.pixel_bytes = channels};
  const bool deep_gray = header.data[kBits] == 16 && (channels == 1 || channels == 2);
  return {.pixel_bytes = deep_gray ? 2 * channels : 0, .deep = deep_gray};
}

/// True for a chunk that libpng leaves out, too. The name of such a chunk begins with a small letter, but tRNS, a
/// transparent color, is part of the image.
bool canBeSkipped(const PngChunk& chunk) {
  const auto small = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto large = [](char c) { return c >= 'A' && c <= 'Z'; };
  return std::ranges::all_of(chunk.name, [&](char c) { return small(c) || large(c); }) && small(chunk.name[0]) &&
         large(chunk.name[2]) && chunk.name != "tRNS" && chunk.data.size() <= kMostToSkip_bytes;
}

/// Adds the IDAT chunk at the beginning of `at`, if it directly follows the previous one.
bool addImageChunk(CommonPng& png, std::string_view at, std::size_t data_bytes) {
  if (png.image_chunks.empty()) png.image_chunks = at.substr(0, 0);
  if (png.image_chunks.data() + png.image_chunks.size() != at.data()) return false;
  png.image_chunks = {png.image_chunks.data(), png.image_chunks.size() + kAroundData_bytes + data_bytes};
  png.packed_bytes += data_bytes;
  return true;
}

}  // namespace

std::optional<PngChunk> takeChunk(std::string_view& bytes) {
  if (bytes.size() < kAroundData_bytes) return std::nullopt;
  const std::size_t length = bigEndian32(bytes, 0);
  if (length > bytes.size() - kAroundData_bytes) return std::nullopt;
  const std::string_view name_and_data = bytes.substr(4, 4 + length);
  const std::uint32_t checksum = bigEndian32(bytes, kLengthAndName_bytes + length);
  if (libdeflate_crc32(0, name_and_data.data(), name_and_data.size()) != checksum) return std::nullopt;
  bytes.remove_prefix(kAroundData_bytes + length);
  return PngChunk{name_and_data.substr(0, 4), name_and_data.substr(4)};
}

std::optional<CommonPng> findCommonPng(std::string_view bytes) {
  if (!bytes.starts_with(kPngSignature)) return std::nullopt;
  bytes.remove_prefix(kPngSignature.size());
  const auto header = takeChunk(bytes);
  CommonPng png = header ? commonPngOf(*header) : CommonPng{};
  if (png.pixel_bytes == 0) return std::nullopt;
  while (true) {
    const std::string_view at = bytes;
    const auto chunk = takeChunk(bytes);
    if (!chunk) return std::nullopt;
    if (chunk->name == "IEND") break;  // what follows is not read
    const bool good = chunk->name == "IDAT" ? addImageChunk(png, at, chunk->data.size()) : canBeSkipped(*chunk);
    if (!good) return std::nullopt;
  }
  return png;
}

void joinImageChunks(const CommonPng& png, std::uint8_t* to) {
  for (std::string_view rest = png.image_chunks; !rest.empty();) {
    const std::size_t length = bigEndian32(rest, 0);
    std::memcpy(to, rest.data() + kLengthAndName_bytes, length);
    to += length;
    rest.remove_prefix(kAroundData_bytes + length);
  }
}

}  // namespace motorcade
