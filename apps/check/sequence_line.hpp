#pragma once

#include <string>

#include "io/sequence/sequence.hpp"

namespace motorcade {

/// The first line of `run` and `check`: layout, frames, camera, and the calibration in force.
std::string sequenceLine(const Sequence& sequence, const FrameRange& range);

}  // namespace motorcade
