#include "apps/run/process_usage.hpp"

#include <fstream>
#include <string>

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

namespace motorcade {
namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// The first line of /proc/stat: cpu user nice system idle iowait irq softirq steal ..., in clock ticks.
double stolen_s() {
  std::ifstream stat("/proc/stat");
  std::string name;
  stat >> name;
  double ticks = 0;
  for (int field = 0; field < 8; ++field)
    if (!(stat >> ticks)) return 0;
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace

ProcessUsage ProcessUsage::since(const ProcessUsage& start) const {
  ProcessUsage used = *this;
  used.cpu_s -= start.cpu_s;
  used.stolen_s -= start.stolen_s;
  used.involuntary_switches -= start.involuntary_switches;
  return used;
}

ProcessUsage processUsage() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime),
          .stolen_s = stolen_s(),
          .involuntary_switches = usage.ru_nivcsw,
          .peak_memory_bytes = std::int64_t{1024} * usage.ru_maxrss};
}

void giveBackSpareMemory() { malloc_trim(0); }

}  // namespace motorcade
