#include "core/object_pool.hpp"

#include <cstdint>

#include <sys/mman.h>
#include <unistd.h>

namespace motorcade {

void populatePages([[maybe_unused]] std::byte* begin, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_POPULATE_WRITE
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE)), at = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (at + page - 1) / page * page, end = (at + bytes) / page * page;
  if (first < end) madvise(begin + (first - at), end - first, MADV_POPULATE_WRITE);
#endif
}

}  // namespace motorcade
