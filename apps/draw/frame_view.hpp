#pragma once

#include "apps/draw/image_view.hpp"

namespace motorcade {

/// The left image above the view from the top, with facts about the frame between them and a legend below. All frames
/// of a drive have the same size.
RgbImage drawFrame(const DrawnImages& images, const RecordedDrive& drive, std::size_t frame);

}  // namespace motorcade
