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
/// Of a glob it is the path from the first part with a wildcard on, of a scene the scene's.
std::vector<FoundDrive> findDrives(const ManifestEntry& entry, const std::filesystem::path& root);

}  // namespace motorcade
