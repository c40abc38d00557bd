#pragma once

#include <filesystem>

namespace motorcade {

/// The file of the running program. Throws UsageError where /proc does not tell.
std::filesystem::path ownProgram();

}  // namespace motorcade
