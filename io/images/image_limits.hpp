#pragma once

#include <vector>

#include "core/parameters.hpp"

namespace motorcade {

/// Beyond these no image is read, whatever its header tells: a few bytes may tell of more than the memory.
inline constexpr int kMaxImage_pixels = 1 << 26;  // 8192 x 8192
inline constexpr int kMaxImageFile_mb = 256;

/// What a user takes as too large for a camera's image.
struct ImageLimits {
  int max_pixels = kMaxImage_pixels;
  int max_file_mb = kMaxImageFile_mb;
};

std::vector<Parameter> parametersOf(ImageLimits& limits);

}  // namespace motorcade
