#include "core/thread_placement.hpp"

#include <cstring>

#include <pthread.h>
#include <sched.h>

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

}  // namespace motorcade
