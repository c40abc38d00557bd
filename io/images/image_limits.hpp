#pragma once

#include <vector>

#include "core/parameters.hpp"

namespace motorcade {

/// Images and files above these limits are refused, whatever their header says: a few bytes may claim more than the
/// memory.
inline constexpr int kMaxImage_pixels = 1 << 26;  // 8192 x 8192
inline constexpr int kMaxImageFile_mb = 256;

/// The user's limits for images of a camera.
struct ImageLimits {
  int max_pixels = kMaxImage_pixels;
  int max_file_mb = kMaxImageFile_mb;
};

std::vector<Parameter> parametersOf(ImageLimits& limits);

}  // namespace motorcade
