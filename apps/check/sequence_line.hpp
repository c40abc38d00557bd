#pragma once

#include <string>

#include "io/sequence/sequence.hpp"

namespace motorcade {

/// The line that `run` and `check` begin with: layout, frames, camera, and the calibration in force.
std::string sequenceLine(const Sequence& sequence, const FrameRange& range);

}  // namespace motorcade
