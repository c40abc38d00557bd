#pragma once

#include <cstdint>
#include <string>

#include "core/image.hpp"

/// Images as faulty cameras and links deliver them. Each function returns a new image of the same size.
namespace motorcade {

Image filled(const Image& like, std::uint8_t gray, ImagePool& pool);
/// Mean over a box of `width_px` (rounded up to an odd number) each way; the border's pixels are repeated.
Image blurred(const Image& image, double width_px, ImagePool& pool);
/// Gaussian noise, clamped to 0..255.
Image withNoise(const Image& image, double sigma_gray, std::uint64_t seed, ImagePool& pool);
/// Gray levels times a factor, clamped to 255.
Image exposed(const Image& image, double factor, ImagePool& pool);
/// Compresses the image as JPEG and decodes it.
Image throughJpeg(const Image& image, int quality, ImagePool& pool);
/// The image of a camera that stands this many rows too high: its content is lower. Interpolated bilinearly, as are the
/// next three; the border's pixels are repeated.
Image lowered(const Image& image, double rows_px, ImagePool& pool);
/// Turned clockwise about its middle.
Image rolled(const Image& image, double angle_rad, ImagePool& pool);
/// Larger by this factor about its middle.
Image zoomed(const Image& image, double factor, ImagePool& pool);
/// Distorted radially about its middle, r (1 + k1 r^2), as by a lens; r = 1 at half the image's width.
Image distorted(const Image& image, double k1, ImagePool& pool);

/// The bytes of a file with `count` random bits flipped.
std::string withBitFlips(std::string bytes, int count, std::uint64_t seed);

}  // namespace motorcade
