#pragma once

#include <cstddef>
#include <filesystem>

#include "io/results/run_folder.hpp"

namespace motorcade {

/// Writes a run's trajectories into `folder`, for tools that compare trajectories. `camera.tum` holds T_world_cam,
/// `object_NNN.tum` of each track T_world_body. Predicted rows are left out unless they are asked for. Returns the
/// number of objects. Throws OutputError.
std::size_t exportTum(const RunFolder& run, const std::filesystem::path& folder, bool with_predicted);

}  // namespace motorcade
