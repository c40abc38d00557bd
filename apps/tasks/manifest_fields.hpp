#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/tasks/manifest.hpp"

/// Fields that both forms of a manifest share: keys with one or several words.
namespace motorcade {

struct ManifestFields {
  std::map<std::string, std::vector<std::string>> words{};
  std::string where{};  // file and line, for messages
};

/// One entry, or one for each value of `each`, which replaces {} in the other keys. Throws UsageError naming the place,
/// the key and how to fix it.
std::vector<ManifestEntry> manifestEntries(const ManifestFields& fields);

/// The key of a table's column by its head, in any case. For `path` it may also be drive, sequence, folder and the
/// like. Empty for other heads.
std::string columnKey(const std::string& head);

/// Numbers and ranges of them, as 1-5, in ascending order. Throws UsageError.
std::vector<std::uint32_t> seedsIn(const std::vector<std::string>& words, const std::string& where);

/// Checks the name of a drive or a set, which becomes the name of a folder. Throws UsageError.
void requireName(const std::string& name, const std::string& where);

Manifest readManifestToml(const std::filesystem::path& file, const std::string& text);
Manifest readManifestCsv(const std::filesystem::path& file, const std::string& text);

}  // namespace motorcade
