#include "apps/batch/slots.hpp"

#include <cstddef>

#include <sched.h>

namespace motorcade {

std::vector<int> usableProcessors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> usable;
  if (::sched_getaffinity(0, sizeof(set), &set) != 0) return usable;
  for (int processor = 0; processor < CPU_SETSIZE; ++processor)
    if (CPU_ISSET(static_cast<std::size_t>(processor), &set)) usable.push_back(processor);
  return usable;
}

std::vector<std::vector<int>> processorSlots(const std::vector<int>& usable, int jobs, int threads) {
  std::vector<std::vector<int>> slots(static_cast<std::size_t>(jobs));
  if (usable.size() < static_cast<std::size_t>(jobs) * static_cast<std::size_t>(threads)) return slots;
  auto next = usable.begin();
  for (auto& slot : slots) {
    slot.assign(next, next + threads);
    next += threads;
  }
  return slots;
}

}  // namespace motorcade
