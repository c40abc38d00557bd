#pragma once

#include <cstddef>

namespace motorcade::perf {

/// Of this process, as the system sees it: freed memory that the allocator keeps counts too.
std::size_t residentBytes();
/// Handed out by the allocator and not given back.
std::size_t heapBytes();

}  // namespace motorcade::perf
