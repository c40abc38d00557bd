#pragma once

#include <vector>

namespace motorcade {

/// The processors that this process may use, in ascending order.
std::vector<int> usableProcessors();

/// The processors of each of `jobs` tasks that run side by side, so that their times are comparable. With fewer
/// processors than `jobs` times `threads`, tasks may use any: the lists are empty.
std::vector<std::vector<int>> processorSlots(const std::vector<int>& usable, int jobs, int threads);

}  // namespace motorcade
