#include "core/thread_placement.hpp"

#include <cassert>
#include <cstring>

#include <pthread.h>
#include <sched.h>
#include <unistd.h>

namespace motorcade {
namespace {

cpu_set_t setOf(const std::vector<int>& cpus) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int cpu : cpus)
    if (cpu >= 0 && cpu < CPU_SETSIZE) CPU_SET(cpu, &set);
  return set;
}

std::vector<int> cpusOfThisThread() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> cpus;
  if (pthread_getaffinity_np(pthread_self(), sizeof set, &set) != 0) return cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(cpu, &set)) cpus.push_back(cpu);
  return cpus;
}

int setAffinity(const std::vector<int>& cpus) {
  const cpu_set_t set = setOf(cpus);
  return pthread_setaffinity_np(pthread_self(), sizeof set, &set);
}

int setScheduling(int policy, int priority) {
  sched_param parameter{};
  parameter.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), policy, &parameter);
}

}  // namespace

PlacedThread::PlacedThread(const ThreadPlacement& placement) {
  if (!placement.cpus.empty()) moveTo(placement.cpus);
  if (placement.realtime_priority > 0) hurry(placement.realtime_priority);
}

PlacedThread::~PlacedThread() {
  if (!cpus_before_.empty()) setAffinity(cpus_before_);
  if (hurried_) setScheduling(policy_before_, priority_before_);
}

void PlacedThread::moveTo(const std::vector<int>& cpus) {
  cpus_before_ = cpusOfThisThread();
  if (const int error = setAffinity(cpus); error != 0)
    problem_ = std::string("these processors are not there for this process: ") + std::strerror(error);
}

void PlacedThread::hurry(int realtime_priority) {
  sched_param before{};
  if (pthread_getschedparam(pthread_self(), &policy_before_, &before) != 0) return;
  priority_before_ = before.sched_priority;
  const int error = setScheduling(SCHED_FIFO, realtime_priority);
  hurried_ = error == 0;
  if (error != 0)
    problem_ = std::string(
                   "SCHED_FIFO is not permitted to this process (CAP_SYS_NICE, or a limit on real-time "
                   "priorities in limits.conf): ") +
               std::strerror(error);
}

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
