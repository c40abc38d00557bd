#include <array>

#include "apps/tasks/manifest.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

namespace {

/// Requires that a manifest can be planned: one of the two kinds of drives, and names that are names of folders.
void requirePlannable(const Manifest& manifest) {
  for (const ManifestEntry& entry : manifest.entries) {
    fuzz::require(entry.path.empty() != entry.scene.empty(), "an entry of both kinds, or of none");
    fuzz::require(entry.repetitions > 0, "an entry that is never run");
    fuzz::require(entry.name.find('/') == std::string::npos, "a name that leads elsewhere");
  }
  for (const ParameterSet& set : manifest.sets)
    fuzz::require(!set.name.empty() && set.name.find('/') == std::string::npos, "a set that leads elsewhere");
}

}  // namespace

/// A manifest, as TOML and as a table.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(fuzz::textOf(data, size));
  const std::filesystem::path name = "manifest";
  fuzz::readOrRefuse(name.native(), {}, [&] { requirePlannable(readManifestToml(name, text)); });
  constexpr std::array<std::string_view, 1> kOfTheFile{"is not UTF-8"};
  fuzz::readOrRefuse(name.native(), kOfTheFile, [&] { requirePlannable(readManifestCsv(name, text)); });
  return 0;
}
