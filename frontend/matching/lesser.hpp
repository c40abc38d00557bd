#pragma once

#include <cstdint>

namespace motorcade {

/// Minimum and maximum by value: the standard library's, which take references, become branches.
inline std::int64_t lesser(std::int64_t a, std::int64_t b) { return a < b ? a : b; }
inline std::int64_t greater(std::int64_t a, std::int64_t b) { return a < b ? b : a; }

}  // namespace motorcade
