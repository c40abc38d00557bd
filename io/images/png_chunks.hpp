#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace motorcade {

inline constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";

/// A number of four bytes, the most significant first.
constexpr std::uint32_t bigEndian32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

struct PngChunk {
  std::string_view name, data;
};

/// Takes the first chunk off `bytes`, which begin behind the signature. Empty when it is cut or its checksum is wrong.
std::optional<PngChunk> takeChunk(std::string_view& bytes);

/// The location of the pixels in a common PNG: 8-bit gray or color, or 16-bit gray, with or without alpha. Such a file
/// is not interlaced and has no chunk that would change pixels.
struct CommonPng {
  int pixel_bytes = 0;
  bool deep = false;                // 16-bit gray
  std::string_view image_chunks{};  // the IDATs, one behind the other, each with its length, name and checksum
  std::size_t packed_bytes = 0;     // what they hold
};

/// Empty for any other PNG, and where chunks are cut, out of order or of a wrong checksum. `bytes` are a whole file
/// that begins with the signature.
std::optional<CommonPng> findCommonPng(std::string_view bytes);

/// Joins the contents of the IDATs; `to` has room for it.
void joinImageChunks(const CommonPng& png, std::uint8_t* to);

}  // namespace motorcade
