#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "io/sequence/image_names.hpp"

namespace motorcade {

/// Times that the names of images tell.
struct NameTimes {
  std::vector<std::int64_t> all_ns;  // of each name
  std::int64_t unit_ns = 1;          // of the numbers in the names; a second where they have a fraction, or are dates
};

/// Reads the times in the names of one side, which have the same text and come in natural order. They are dates with a
/// time of day, seconds with a fraction, or whole numbers of nanoseconds, microseconds, milliseconds or seconds. The
/// unit is the one by which the numbers lie within this century or the images are as far apart as a camera's. Numbers
/// that merely count are no times. Empty where the names do not give times that all differ.
std::optional<NameTimes> timesOfNames(const std::vector<NameParts>& names);

}  // namespace motorcade
