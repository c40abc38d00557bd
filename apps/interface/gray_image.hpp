#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <string>

#include "core/image.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// The longest stride that is accepted: a longer one is a mistake.
inline constexpr std::ptrdiff_t kMostStride_bytes = 1 << 24;

/// Bytes from row to row, also where the caller gives none.
std::ptrdiff_t strideOf(const Pair::Image& image);

/// Reason why an image cannot be one of this camera; null when it can.
const char* problemOf(const Pair::Image& image, const Camera& camera);

/// Finds the number of bits that 16-bit samples use, as cameras have ten, twelve or fourteen. Call it for each pair in
/// turn. The first pair that is not dark decides for all that follow.
class SampleBits {
 public:
  /// The bits of this pair's samples, the same for both images. The pair has no problem.
  int of(const Pair& pair);
  /// Returns the finding once, as a sentence. Call it where results are delivered, so that a push writes no text.
  std::optional<std::string> news();

 private:
  int brightest_ = 0;
  std::atomic<int> decided_{0};  // 0 until it is known; published after `brightest_`, which stays from then on
  bool told_ = false;            // the delivering thread's
};

/// The image as 8-bit gray in a buffer of the pool: the one copy between the caller and the stages. Of 16-bit samples
/// the upper eight of `sample_bits` are used.
Image grayImage(const Pair::Image& image, int sample_bits, ImagePool& pool);

}  // namespace motorcade
