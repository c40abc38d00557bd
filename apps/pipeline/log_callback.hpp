#pragma once

#include <functional>
#include <string>

namespace motorcade {

enum class LogLevel { kInfo, kWarning, kError };
/// Called from the pipeline's threads, several at once.
using LogCallback = std::function<void(LogLevel, const std::string&)>;

}  // namespace motorcade
