#pragma once

#include <string>
#include <string_view>
#include <vector>

/// The messages of the programs, on the standard error output.
namespace motorcade {

/// One message. Callers format it, so that the logging library is compiled here alone.
void logDebug(std::string_view message);
void logInfo(std::string_view message);
void logWarning(std::string_view message);
void logError(std::string_view message);

/// Starts the log. It is colored on a terminal, unless the environment says NO_COLOR (https://no-color.org).
void startLog();

/// `trace`, `debug`, `info`, `warning`, `error`, `critical`, `off`: each also shows the messages of those after it.
std::vector<std::string> logLevelNames();
void setLogLevel(const std::string& name);

/// True when the user wants to read more than warnings and errors: progress and short reports.
bool tellsProgress();

}  // namespace motorcade
