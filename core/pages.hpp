#pragma once

#include <cstddef>

namespace motorcade {

/// Asks for all pages of fresh memory at once: a fault for each is dear, most of all on virtual machines. Where the
/// system does not know that, they come one after the other.
void populatePages(std::byte* begin, std::size_t bytes);

}  // namespace motorcade
