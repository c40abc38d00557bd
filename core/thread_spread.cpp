#include "core/thread_spread.hpp"

#include <cassert>

#include <unistd.h>

namespace motorcade {

void ThreadSpread::occupy(std::size_t index) {
  assert(index < seats_.size());
  Seat& seat = seats_[index];
  const int cpu = sched_getcpu();
  if (cpu == seat.cpu.load(std::memory_order_relaxed) || seats_.size() < 2) return;
  const std::scoped_lock lock(mutex_);
  if (seat.thread == 0) {
    CPU_ZERO(&seat.allowed);
    if (sched_getaffinity(0, sizeof seat.allowed, &seat.allowed) != 0) return;
    seat.thread = gettid();
  }
  // A thread on another's processor moves at once. The others, which may sleep, are kept off its new one.
  keepOff(seat);
  seat.cpu.store(sched_getcpu(), std::memory_order_relaxed);
  for (const Seat& other : seats_)
    if (&other != &seat) keepOff(other);
}

void ThreadSpread::keepOff(const Seat& seat) const {
  if (seat.thread == 0 || static_cast<std::size_t>(CPU_COUNT(&seat.allowed)) < seats_.size()) return;
  cpu_set_t free = seat.allowed;
  for (const Seat& other : seats_)
    if (const int cpu = other.cpu.load(std::memory_order_relaxed); &other != &seat && cpu >= 0) CPU_CLR(cpu, &free);
  if (CPU_COUNT(&free) > 0) sched_setaffinity(seat.thread, sizeof free, &free);
}

}  // namespace motorcade
