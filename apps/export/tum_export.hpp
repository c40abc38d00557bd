#pragma once

#include <cstddef>
#include <filesystem>

#include "io/results/run_folder.hpp"

namespace motorcade {

/// Writes a run's trajectories for tools that compare trajectories, into `folder`: `camera.tum`, and `object_NNN.tum`
/// of each track, poses of T_world_cam and T_world_body. Rows that were predicted are left out unless they are asked
/// for. Gives the number of objects. Throws OutputError.
std::size_t exportTum(const RunFolder& run, const std::filesystem::path& folder, bool with_predicted);

}  // namespace motorcade
