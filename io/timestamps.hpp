#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "core/timestamp.hpp"
#include "io/text_file.hpp"

namespace motorcade {

/// Reads one time per line: seconds (`12.5`, `1.25e+01`) or a date with a time of day (`2011-09-26 13:10:51.175862102`,
/// taken as UTC), exact to the nanosecond. Times must increase. Throws InputError naming file and line.
std::vector<Timestamp> readTimestamps(const std::filesystem::path& file);

/// The same of lines that are read already; whole numbers that are too large or too far apart for seconds are
/// nanoseconds.
std::vector<Timestamp> parseTimestamps(const std::filesystem::path& file, const std::vector<TextLine>& lines);

}  // namespace motorcade
