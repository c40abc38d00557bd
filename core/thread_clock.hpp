#pragma once

#include <ctime>

namespace motorcade {

/// Time that the calling thread has spent on a processor. Other programs on the machine do not count.
inline double threadCpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace motorcade
