#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace motorcade {

/// The first line of a YUV4MPEG2 stream, which holds for all its frames.
struct Y4mHeader {
  int width = 0, height = 0;
  std::optional<double> rate_hz{};  // none where the stream tells none
  bool interlaced = false;
  int bits = 8;                    // of a sample, which has two bytes where it has more than 8 bits
  std::size_t chroma_samples = 0;  // of a frame, after those of the luma plane

  std::size_t sampleBytes() const { return bits > 8 ? 2 : 1; }
  std::size_t lumaBytes() const {
    return sampleBytes() * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t chromaBytes() const { return sampleBytes() * chroma_samples; }
};

/// Parses the line, without its end. Sizes are such that no product of them overflows. Throws InputError, which begins
/// with `name`.
Y4mHeader parseY4mHeader(std::string_view line, const std::string& name);

/// A command whose output `motorcade run -` reads, for messages.
inline constexpr const char* kY4mCommand =
    "\n  ffmpeg -i INPUT -f yuv4mpegpipe -pix_fmt gray -strict -1 - | motorcade run - --side-by-side ...";

}  // namespace motorcade
