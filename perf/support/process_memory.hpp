#pragma once

#include <cstddef>

namespace motorcade::perf {

/// Resident memory of this process, as the system sees it: freed memory that the allocator keeps counts too.
std::size_t residentBytes();
/// Memory that the allocator handed out and did not get back.
std::size_t heapBytes();

}  // namespace motorcade::perf
