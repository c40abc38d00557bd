#pragma once

#include <cstddef>

#include "io/results/run_folder.hpp"

namespace motorcade {

/// Completes the final estimates of a run that did not end in order. Frames without one get the online estimate, moved
/// to the camera's last final pose. Returns their number.
std::size_t recoverFinals(RunFolder& run);

}  // namespace motorcade
