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

/// In color where that output is a terminal and the environment does not say NO_COLOR (https://no-color.org).
void startLog();

/// `trace`, `debug`, `info`, `warning`, `error`, `critical`, `off`: each shows the messages of the later ones too.
std::vector<std::string> logLevelNames();
void setLogLevel(const std::string& name);

/// Whether the user wants to read more than warnings and errors: progress and short reports.
bool tellsProgress();

}  // namespace motorcade
