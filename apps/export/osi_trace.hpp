#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/se3.hpp"
#include "io/results/run_folder.hpp"

namespace motorcade {

struct OsiTrace {
  std::size_t frames = 0, objects = 0;  // messages, and objects in all of them
  std::uint64_t bytes = 0;
};

/// Writes an ASAM OSI trace of a run (docs/formats.md): an MCAP file with one osi3.SensorData per frame. The same run
/// gives the same bytes. Throws OutputError naming the file.
OsiTrace exportOsi(const RunFolder& run, const std::filesystem::path& file, const std::optional<SE3>& T_vehicle_sensor);

}  // namespace motorcade
