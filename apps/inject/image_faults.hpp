#pragma once

#include <cstdint>
#include <string>

#include "core/image.hpp"

/// Images as faulty cameras and links give them. Each function gives a new image of the same size.
namespace motorcade {

Image filled(const Image& like, std::uint8_t gray, ImagePool& pool);
/// Mean over a box of `width_px` (rounded up to an odd number) each way; the border's pixels are repeated.
Image blurred(const Image& image, double width_px, ImagePool& pool);
/// Gaussian noise, clamped to 0..255.
Image withNoise(const Image& image, double sigma_gray, std::uint64_t seed, ImagePool& pool);
/// Gray levels times a factor, clamped to 255.
Image exposed(const Image& image, double factor, ImagePool& pool);
/// Through JPEG compression and back.
Image throughJpeg(const Image& image, int quality, ImagePool& pool);

/// The bytes of a file with `count` random bits turned.
std::string withBitFlips(std::string bytes, int count, std::uint64_t seed);

}  // namespace motorcade
