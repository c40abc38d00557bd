#pragma once

#include "apps/draw/palette.hpp"
#include "apps/recorded/recorded_drive.hpp"

namespace motorcade {

/// The scene from above, the camera heading right: the ways so far of camera and objects, the objects' points and
/// footprints, where these may be by two standard deviations, and their motion of one second; the truth is dashed.
Canvas drawTopView(const RecordedDrive& run, std::size_t frame, int width, int height);

}  // namespace motorcade
