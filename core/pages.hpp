#pragma once

#include <cstddef>

namespace motorcade {

/// Faults in all pages of fresh memory at once: single faults are expensive, above all on virtual machines. On systems
/// that cannot do that, the pages come one after the other.
void populatePages(std::byte* begin, std::size_t bytes);

}  // namespace motorcade
