#pragma once

#include "apps/draw/palette.hpp"
#include "apps/recorded/recorded_drive.hpp"

namespace motorcade {

/// The image above the view from the top.
Canvas drawFrame(const DrawnImages& images, const RecordedDrive& run, std::size_t frame);

}  // namespace motorcade
