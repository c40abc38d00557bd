#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/timestamp.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {

/// Times of a file, and the unit that its numbers have.
struct Times {
  std::vector<Timestamp> stamps{};
  std::int64_t unit_ns = 1'000'000'000;
};

/// Reads one time per line: seconds (`12.5`, `1.25e+01`) or a date with a time of day (`2011-09-26 13:10:51.175862102`,
/// taken as UTC), exact to the nanosecond. If images would be seconds apart throughout, the numbers are milliseconds,
/// microseconds or nanoseconds, by the unit in which a camera might have taken them. `#` begins a comment. Times must
/// increase. Throws InputError naming file and line.
Times readTimes(const std::filesystem::path& file);
/// The same of lines that are read already.
Times parseTimes(const std::filesystem::path& file, const std::vector<TextLine>& lines);

/// The time of one line, in seconds or as a date.
Timestamp readTime(const std::filesystem::path& file, const TextLine& line);

/// The times alone.
std::vector<Timestamp> readTimestamps(const std::filesystem::path& file);

/// The time of a frame by its number at a constant rate.
Timestamp stampAtRate(std::int64_t number, double rate_hz);

/// The name of a unit of time, in the plural.
std::string unitName(std::int64_t unit_ns);

}  // namespace motorcade
