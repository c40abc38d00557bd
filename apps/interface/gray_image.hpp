#pragma once

#include "core/image.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Why an image cannot be one of this camera; null when it can.
const char* problemOf(const Pair::Image& image, const Camera& camera);

/// The image as 8-bit gray in a buffer of the pool: the one copy between the caller and the stages.
Image grayImage(const Pair::Image& image, ImagePool& pool);

}  // namespace motorcade
