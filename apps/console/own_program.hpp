#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace motorcade {

/// The file of the running program. Throws UsageError where /proc does not tell.
std::filesystem::path ownProgram();

/// The program, its build and its libraries, by name.
std::vector<std::pair<std::string, std::string>> versions();

/// The same as lines for the user; the first one has the program's name and version.
std::string versionsText();

}  // namespace motorcade
