#pragma once

#include <vector>

namespace motorcade {

/// The processors that this process may use, in ascending order.
std::vector<int> usableProcessors();

/// For each of `jobs` tasks side by side the processors that it is kept to, so that times are comparable. Where there
/// are fewer than `jobs` times `threads`, tasks are not kept to any: the lists are empty.
std::vector<std::vector<int>> processorSlots(const std::vector<int>& usable, int jobs, int threads);

}  // namespace motorcade
