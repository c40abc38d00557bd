#include "apps/inject/process_limits.hpp"

#include <fstream>

#include <sys/resource.h>
#include <unistd.h>

namespace motorcade {
namespace {

std::uint64_t addressSpace_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

void limitFurtherMemory(std::uint64_t bytes) {
  const rlim_t limit = addressSpace_bytes() + bytes;
  const rlimit both{limit, limit};
  setrlimit(RLIMIT_AS, &both);
}

void limitFileSize(std::uint64_t bytes) {
  const rlimit both{bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &both);
}

}  // namespace motorcade
