#pragma once

#include <cstddef>

#include "io/results/run_folder.hpp"

namespace motorcade {

/// Gives a run that did not end in order final estimates of all of its frames: those that have none get the online
/// ones, moved to where the last final pose of the camera is. Returns how many frames these are.
std::size_t recoverFinals(RunFolder& run);

}  // namespace motorcade
