#include "core/thread_placement.hpp"

#include <barrier>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

std::vector<int> cpusOfThisThread() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> cpus;
  if (sched_getaffinity(0, sizeof set, &set) != 0) return cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(cpu, &set)) cpus.push_back(cpu);
  return cpus;
}

/// Processors that `threads` threads that began on the same one may run on after all have settled.
std::vector<std::vector<int>> cpusAfterSettling(std::size_t threads) {
  const std::vector<int> all = cpusOfThisThread();
  ThreadSpread spread(threads);
  std::barrier together(static_cast<std::ptrdiff_t>(threads));
  std::vector<std::vector<int>> cpus(threads);
  std::vector<std::jthread> running;
  for (std::size_t seat = 0; seat < threads; ++seat)
    running.emplace_back([&, seat] {
      together.arrive_and_wait();
      for (std::size_t turn = 0; turn < threads; ++turn) {
        if (turn == seat) spread.occupy(seat);
        together.arrive_and_wait();
      }
      cpus[seat] = cpusOfThisThread();
    });
  running.clear();
  return cpus;
}

TEST(ThreadSpread, KeepsTwoThreadsOffEachOthersProcessors) {
  const std::vector<int> all = cpusOfThisThread();
  if (all.size() < 2) GTEST_SKIP() << "there is one processor";
  const auto cpus = cpusAfterSettling(2);
  EXPECT_EQ(cpus[0].size(), all.size() - 1);
  EXPECT_EQ(cpus[1].size(), all.size() - 1);
  EXPECT_NE(cpus[0], cpus[1]);
}

TEST(ThreadSpread, LeavesAThreadThatIsAloneAsItIs) { EXPECT_EQ(cpusAfterSettling(1).front(), cpusOfThisThread()); }

TEST(ThreadSpread, LeavesThreadsAsTheyAreWhereThereAreMoreThanProcessors) {
  const std::vector<int> all = cpusOfThisThread();
  for (const auto& cpus : cpusAfterSettling(all.size() + 1)) EXPECT_EQ(cpus, all);
}

}  // namespace
}  // namespace motorcade
