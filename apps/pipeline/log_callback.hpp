#pragma once

#include <functional>
#include <new>
#include <string>

namespace motorcade {

enum class LogLevel { kInfo, kWarning, kError };
/// Called from the pipeline's threads, several at once.
using LogCallback = std::function<void(LogLevel, const std::string&)>;

/// A problem that is short enough for a string without heap memory.
inline constexpr const char* kNoMemoryLeft = "out of memory";

/// Logs the result of `text`. If memory for the line is lacking, it is left out: it must not cost a frame.
template <class Text>
void tell(const LogCallback& log, LogLevel level, const Text& text) {
  try {
    log(level, text());
  } catch (const std::bad_alloc&) {
    return;
  }
}

}  // namespace motorcade
