#include "apps/evaluate/report/table_text.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

namespace motorcade {

void print(std::string& text, const char* format, ...) {
  char line[256];
  std::va_list arguments;
  va_start(arguments, format);
  // NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized): va_start above is not seen
  const int length = std::vsnprintf(line, sizeof(line), format, arguments);
  va_end(arguments);
  text.append(line, std::min<std::size_t>(static_cast<std::size_t>(length), sizeof(line) - 1));
}

}  // namespace motorcade
