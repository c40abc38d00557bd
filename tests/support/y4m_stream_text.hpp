#pragma once

#include <cstddef>
#include <string>

#include "core/image.hpp"
#include "io/stream/stereo_packing.hpp"

namespace motorcade::test {

/// The first line of a YUV4MPEG2 stream whose pictures hold two images of a size each.
inline std::string y4mHeaderLine(ImageSize size, StereoPacking packing, const std::string& tags = "F10:1 Ip Cmono") {
  const bool beside = packing == StereoPacking::kSideBySide;
  return "YUV4MPEG2 W" + std::to_string(beside ? 2 * size.width : size.width) + " H" +
         std::to_string(beside ? size.height : 2 * size.height) + (tags.empty() ? "" : " " + tags) + "\n";
}

inline void appendRow(std::string& text, const Image& image, int y) {
  const auto* row = reinterpret_cast<const char*>(image.row(y));
  text.append(row, static_cast<std::size_t>(image.width()));
}

/// A frame of such a stream, in 8-bit gray.
inline std::string y4mFrame(const Image& left, const Image& right, StereoPacking packing) {
  std::string frame = "FRAME\n";
  for (int y = 0; y < left.height(); ++y) {
    appendRow(frame, left, y);
    if (packing == StereoPacking::kSideBySide) appendRow(frame, right, y);
  }
  if (packing == StereoPacking::kOverUnder)
    for (int y = 0; y < right.height(); ++y) appendRow(frame, right, y);
  return frame;
}

}  // namespace motorcade::test
