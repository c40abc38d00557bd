#pragma once

#include <string>
#include <vector>

#include "core/pixel_mask.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// The pixels of the left image that `run --ignore` names: each item is SIDE=PIXELS, so many rows or columns at a side,
/// or the file of an image of the camera's size that is not black there. Throws UsageError or InputError.
PixelMask ignoredPixels(const std::vector<std::string>& items, const StereoCamera& camera);

}  // namespace motorcade
