#pragma once

#include <string>
#include <vector>

#include "core/pixel_mask.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// The pixels of the left image that `run --ignore` names. An item is SIDE=PIXELS, a number of rows or columns at a
/// side. It may also be the file of an image of the camera's size, in which ignored pixels are not black. Throws
/// UsageError or InputError.
PixelMask ignoredPixels(const std::vector<std::string>& items, const StereoCamera& camera);

}  // namespace motorcade
