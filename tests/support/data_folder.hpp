#pragma once

#include <cstdlib>
#include <filesystem>

namespace motorcade::test {

/// Folder of the real drives: the one that MOTORCADE_DATA names, else `../shared/data` beside the repository. Tests
/// that need one skip where it is not there.
inline std::filesystem::path dataFolder() {
  const char* const named = std::getenv("MOTORCADE_DATA");
  return named && *named ? std::filesystem::path(named) : std::filesystem::path(MOTORCADE_SOURCE_DIR "/../shared/data");
}

}  // namespace motorcade::test
