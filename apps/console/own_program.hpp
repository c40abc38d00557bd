#pragma once

#include <filesystem>

namespace motorcade {

/// The file of the program that runs. Throws UsageError where /proc does not tell.
std::filesystem::path ownProgram();

}  // namespace motorcade
