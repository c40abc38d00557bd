#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/view/shown_frame.hpp"

/// Further files of a run folder, by frame.
namespace motorcade {

/// Reads `frames.csv` by the names of its columns. Lines that a killed run cut off are left out.
std::map<std::int64_t, ShownTiming> readTimings(const std::filesystem::path& run_folder);
/// The lines of `outlines.jsonl`; none where the run did not write them.
std::map<std::int64_t, std::vector<std::string>> readOutlineLines(const std::filesystem::path& run_folder);
/// The outline of a line; a damaged line has no polygons. Does not throw.
ShownOutline outlineOf(const std::string& line);

}  // namespace motorcade
