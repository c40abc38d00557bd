#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "io/results/run_folder.hpp"

namespace motorcade {

/// Writes a run's trajectories into `folder`, for tools that compare trajectories. `camera.tum` holds T_world_cam,
/// `object_NNN.tum` of each track T_world_body. Predicted rows are left out unless they are asked for. Returns the
/// number of objects. Throws OutputError.
std::size_t exportTum(const RunFolder& run, const std::filesystem::path& folder, bool with_predicted);

/// The command line of `motorcade export`.
struct ExportOptions {
  std::filesystem::path run{}, sequence{};
  std::optional<double> fps_hz{};
  std::filesystem::path mcap{};  // file
  std::filesystem::path osi{};   // file
  std::string mounting{};        // X,Y,Z,ROLL,PITCH,YAW of `osi`; empty: the camera stands for the vehicle
  std::filesystem::path tum{};   // folder
  bool with_predicted = false;
};

/// Writes a run, also one that was killed, for other programs; gives the exit code. Failures are UserErrors.
int runExport(const ExportOptions& options);

}  // namespace motorcade
