#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <png.h>

namespace motorcade::test {

/// A picture with smooth parts and noise, as libpng writes it.
struct PngSample {
  int width = 61, height = 37;
  int color = PNG_COLOR_TYPE_GRAY, bits = 8, interlace = PNG_INTERLACE_NONE;
  int filters = PNG_ALL_FILTERS;
  int level = 6;
  int idat_bytes = 8192;     // at most, in each IDAT
  bool transparent = false;  // with a transparent color
  bool text = false;         // with a text before the pixels and one behind them

  std::string write() const;
};

/// A chunk of a PNG, with its length and its checksum.
std::string pngChunk(const std::string& name_and_data);
/// Chunks of a file, each whole.
std::vector<std::string> pngChunksOf(std::string_view file);
/// A file of such chunks.
std::string pngOf(const std::vector<std::string>& chunks);

/// The stream of zlib that a file holds, and a file with another one. There is one IDAT.
std::string unpackedIdat(std::string_view file);
std::string withIdat(std::string_view file, const std::string& data);

struct Deflate {
  int level = 6, window_bits = 15, strategy = 0;
  std::string operator()(std::string_view bytes) const;
};

}  // namespace motorcade::test
