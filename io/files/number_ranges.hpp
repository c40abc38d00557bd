#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace motorcade {

/// Ascending numbers for a message, those in a row as a range: "3-7, 9".
std::string rangesOf(std::span<const std::int64_t> numbers);

}  // namespace motorcade
