#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "core/timestamp.hpp"

namespace motorcade {

/// Reads a line of times: seconds (`12.5`, `1.25e+01`) or a date with a time of day (`2011-09-26 13:10:51.175862102`,
/// taken as UTC). Decimals are read exactly to the nanosecond. Throws InputError naming file and line; times must
/// increase.
std::vector<Timestamp> readTimestamps(const std::filesystem::path& file);

}  // namespace motorcade
