#pragma once

#include <cstddef>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace motorcade {

/// Calls `work(i)` for every i below `count`, on whatever threads the arena has to spare, at least `grain` on one
/// thread in a row. The items must not depend on each other. Isolated: a stage that waits for its own items here does
/// not start on another frame.
template <class Work>
void forEachItem(std::size_t count, const Work& work, std::size_t grain = 16) {
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        for (std::size_t i = range.begin(); i != range.end(); ++i) work(i);
                      });
  });
}

/// Number of threads that may work on items at the same time.
inline int threadsForItems() { return tbb::this_task_arena::max_concurrency(); }

}  // namespace motorcade
