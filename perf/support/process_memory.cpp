#include "perf/support/process_memory.hpp"

#include <fstream>

#include <malloc.h>
#include <unistd.h>

namespace motorcade::perf {

std::size_t residentBytes() {
  std::ifstream statm("/proc/self/statm");
  std::size_t size_pages = 0, resident_pages = 0;
  statm >> size_pages >> resident_pages;
  return resident_pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::size_t heapBytes() {
  const auto heap = mallinfo2();
  return heap.uordblks + heap.hblkhd;
}

}  // namespace motorcade::perf
