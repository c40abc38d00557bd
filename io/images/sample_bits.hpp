#pragma once

#include <algorithm>
#include <cstdint>

/// Samples of 16 bits, of which cameras use ten, twelve or fourteen.
namespace motorcade {

/// The samples use all of their bits, or their file says how to scale them.
inline constexpr int kAllSampleBits = 16;

/// The 8-bit sample of one that counts up to 2^bits - 1: its upper eight bits. A brighter one becomes white.
constexpr std::uint8_t upperBits(unsigned sample, int bits) {
  return static_cast<std::uint8_t>(std::min(sample >> (bits - 8), 255U));
}

/// The bits that samples use: the fewest of a camera's usual ones that hold the brightest sample of a drive.
/// `told_bits` are those that the file gives for its camera, 0 for none. If a file says ten bits and has brighter
/// samples, they are scaled up to sixteen, as PNG asks for.
constexpr int usedSampleBits(int told_bits, int brightest) {
  if (told_bits >= 8 && told_bits < kAllSampleBits) return brightest >> told_bits == 0 ? told_bits : kAllSampleBits;
  for (const int bits : {8, 10, 12, 14})
    if (brightest >> bits == 0) return bits;
  return kAllSampleBits;
}

}  // namespace motorcade
