#pragma once

#include <cstddef>

namespace motorcade::perf {

/// What the program has of the allocator and has not given back, in all of the allocator's arenas. Resident memory
/// grows beyond it by what lies unused between allocations: only growth of this one is a leak.
std::size_t heapUse_bytes();

}  // namespace motorcade::perf
