#include "perf/apps/heap_use.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include <malloc.h>

namespace motorcade::perf {
namespace {

/// Size in the last line that begins with `tag`: those of the whole process come after those of the arenas.
std::size_t lastSize(std::string_view report, std::string_view tag) {
  const auto line = report.rfind(tag);
  if (line == std::string_view::npos) return 0;
  constexpr std::string_view kSize = "size=\"";
  const auto size = report.find(kSize, line);
  return std::strtoull(report.data() + size + kSize.size(), nullptr, 10);
}

}  // namespace

std::size_t heapUse_bytes() {
  char* text = nullptr;
  std::size_t length = 0;
  std::FILE* stream = open_memstream(&text, &length);
  if (stream == nullptr) return 0;
  malloc_info(0, stream);
  std::fclose(stream);
  const std::string report(text, length);
  std::free(text);
  return lastSize(report, "<system type=\"current\"") + lastSize(report, "<total type=\"mmap\"") -
         lastSize(report, "<total type=\"fast\"") - lastSize(report, "<total type=\"rest\"");
}

}  // namespace motorcade::perf
