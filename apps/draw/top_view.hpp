#pragma once

#include "apps/draw/drawn_run.hpp"

namespace motorcade {

/// The scene from above, the camera heading right: the ways so far of camera and objects, the objects' points and
/// footprints, where these may be by two standard deviations, and their motion of one second; the truth is dashed.
Canvas drawTopView(const DrawnRun& run, std::size_t frame, int width, int height);

}  // namespace motorcade
