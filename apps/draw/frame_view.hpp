#pragma once

#include "apps/draw/drawn_run.hpp"

namespace motorcade {

/// The image above the view from the top.
Canvas drawFrame(const DrawnImages& images, const DrawnRun& run, std::size_t frame);

}  // namespace motorcade
