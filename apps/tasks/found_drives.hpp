#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/tasks/manifest.hpp"

namespace motorcade {

/// A drive that an entry of a manifest stands for.
struct FoundDrive {
  std::string name{};
  std::filesystem::path path{};  // absolute; empty for a scene
  std::string problem{};         // why there is none; empty where there is
  bool missing = false;          // nothing is there
};

/// The drives of an entry, in the order of their paths. A drive's name is the entry's, else the last part of its path.
/// A glob's drives are named by the path from the first part with a wildcard on, a scene by its own name.
std::vector<FoundDrive> findDrives(const ManifestEntry& entry, const std::filesystem::path& root);

}  // namespace motorcade
