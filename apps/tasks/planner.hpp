#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/tasks/manifest.hpp"
#include "apps/tasks/plan.hpp"

namespace motorcade {

/// Part of a manifest to be performed; an empty field selects all.
struct Selection {
  std::vector<std::string> drives{}, sets{};  // names
  std::string seeds{};                        // of scenes, in place of the manifest's, as 1-5
};

/// Options for performing the tasks of a manifest.
struct PlanOptions {
  std::filesystem::path program{};    // that tasks run; absolute
  std::filesystem::path sequences{};  // folder that scenes are rendered into; absolute
  int threads = 2;                    // of each run
  Selection only{};
};

/// One task for every drive, seed, parameter set and repetition of a manifest. A fault of a drive or a set, but not of
/// the manifest itself, becomes the `problem` of its tasks. Throws UsageError where two drives have one name, or the
/// selection does not exist.
Plan planOf(Manifest manifest, const PlanOptions& options);

}  // namespace motorcade
