#pragma once

#include <cstddef>

namespace motorcade::perf {

/// Bytes that the program holds of the allocator, in all of its arenas. Resident memory is larger by what lies unused
/// between allocations: only growth of these bytes is a leak.
std::size_t heapUse_bytes();

}  // namespace motorcade::perf
