#include "apps/tasks/manifest.hpp"

#include <algorithm>

#include "apps/tasks/manifest_fields.hpp"
#include "apps/tasks/path_text.hpp"
#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 26;

std::string contentOf(const std::filesystem::path& file) {
  try {
    return readWhole(file, kMostBytes);
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
}

bool hasSet(const Manifest& manifest, const std::string& name) {
  return std::ranges::find(manifest.sets, name, &ParameterSet::name) != manifest.sets.end();
}

void requireKnownSets(const Manifest& manifest) {
  for (const ManifestEntry& entry : manifest.entries)
    for (const std::string& set : entry.sets)
      if (!hasSet(manifest, set)) throw UsageError(entry.where + ": there is no [sets." + printable(set) + "]");
  if (!manifest.baseline_set.empty() && !hasSet(manifest, manifest.baseline_set))
    throw UsageError(manifest.file.string() + ": baseline_set: there is no [sets." + printable(manifest.baseline_set) +
                     "]");
}

bool isTable(const std::filesystem::path& file) {
  const std::string end = file.extension().string();
  return end == ".csv" || end == ".tsv" || end == ".txt" || end == ".lst" || end == ".list";
}

/// The manifest's own root, relative to the manifest's folder. It may name a variable of the environment.
std::filesystem::path ownRoot(const Manifest& manifest) {
  const std::string root = expandedPath(manifest.root.string());
  if (const std::string missing = unsetVariable(root); !missing.empty())
    throw UsageError(manifest.file.string() + ": its root is " + missing +
                     ", which is not set; give --root FOLDER, or " + "export " + missing.substr(1) +
                     "=FOLDER, the folder that holds " + printable(manifest.entries.front().path, 80));
  return manifest.file.parent_path() / root;
}

}  // namespace

Manifest readManifest(const std::filesystem::path& file, const std::filesystem::path& root) {
  const auto absolute = std::filesystem::absolute(file).lexically_normal();
  const std::string text = contentOf(absolute);
  const bool table = isTable(file);
  Manifest manifest = table ? readManifestCsv(absolute, text) : readManifestToml(absolute, text);
  if (manifest.entries.empty())
    throw UsageError(file.string() + ": has no drives; write " +
                     (table ? "a line with the path of each" : "[[drives]] with a path or a scene for each"));
  if (manifest.sets.empty()) manifest.sets.push_back({.name = "default"});
  requireKnownSets(manifest);
  manifest.root = root.empty() ? ownRoot(manifest) : std::filesystem::absolute(root);
  manifest.root = manifest.root.lexically_normal();
  return manifest;
}

}  // namespace motorcade
