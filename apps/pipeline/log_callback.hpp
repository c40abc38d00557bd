#pragma once

#include <functional>
#include <new>
#include <string>

namespace motorcade {

enum class LogLevel { kInfo, kWarning, kError };
/// Called from the pipeline's threads, several at once.
using LogCallback = std::function<void(LogLevel, const std::string&)>;

/// A problem in so few letters that the string needs no heap.
inline constexpr const char* kNoMemoryLeft = "out of memory";

/// Logs what `text` makes. A line for which there is no memory is left out: it must not cost a frame.
template <class Text>
void tell(const LogCallback& log, LogLevel level, const Text& text) {
  try {
    log(level, text());
  } catch (const std::bad_alloc&) {
    return;
  }
}

}  // namespace motorcade
