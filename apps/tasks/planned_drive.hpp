#pragma once

#include <cstdint>
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

/// A drive of a manifest, with the facts that are known before it is run.
struct PlannedDrive {
  const ManifestEntry* entry = nullptr;
  FoundDrive found{};
  std::string frame_range{};  // as --frames takes it; empty for all
  std::int64_t frames = 0;
  bool has_truth = false;
  std::string fingerprint{};
};

/// Opens all recorded drives; an error becomes the drive's problem. Several drives are opened at a time, as looking at
/// each of their files takes long on a network.
void openDrives(const Manifest& manifest, std::vector<PlannedDrive>& drives);

/// Describes a scene that is rendered with a seed. Its fingerprint is that of its task, as it depends on nothing else.
void describeScene(PlannedDrive& drive, std::uint32_t seed);

/// An option of `run` or `evaluate` by its name; empty where the entry has none.
std::string optionOf(const ManifestEntry& entry, const std::string& name);
/// An option with the name of a file, which is relative to `root`.
std::filesystem::path fileOption(const ManifestEntry& entry, const std::string& name,
                                 const std::filesystem::path& root);
/// `--calibration` of `run`: one file, or two with a comma between them.
std::string calibrationOption(const ManifestEntry& entry, const std::filesystem::path& root);

}  // namespace motorcade
