#pragma once

#include <cstdint>
#include <span>

#include "core/image.hpp"
#include "io/images/image_file.hpp"
#include "io/stream/y4m_header.hpp"

/// Both images of a pair in one picture.
namespace motorcade {

enum class StereoPacking {
  kSideBySide,  // left | right
  kOverUnder,   // left above right
};

/// Size of either image. Throws InputError, which begins with `name`, where the picture cannot be halved or its half
/// has an impossible size.
ImageSize unpackedSize(const Y4mHeader& header, StereoPacking packing, const std::string& name);

struct ImagePair {
  Image left, right;
};
/// The two images as 8-bit gray. `luma` holds the picture's samples of `bits` bits, row by row without gaps; those of
/// more than 8 bits are little endian, and their upper eight bits are used. `size` is that of either image.
ImagePair unpacked(std::span<const std::uint8_t> luma, int bits, StereoPacking packing, ImageSize size,
                   ImagePool& pool);

}  // namespace motorcade
