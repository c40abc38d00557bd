#include "apps/tasks/found_drives.hpp"

#include <algorithm>
#include <cctype>

#include <glob.h>

#include "apps/tasks/path_text.hpp"
#include "io/files/errors.hpp"
#include "io/files/natural_order.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

bool hasWildcard(std::string_view text) { return text.find_first_of("*?[{") != std::string_view::npos; }

/// Letters that a folder's name should not have become underscores.
std::string nameOf(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '-'; }, '_');
  return text;
}

/// Number of parts of a pattern before the first one with a wildcard.
std::ptrdiff_t partsBeforeWildcard(const fs::path& pattern) {
  return std::distance(pattern.begin(), std::ranges::find_if(pattern.begin(), pattern.end(), [](const fs::path& part) {
                         return hasWildcard(part.string());
                       }));
}

/// The parts of a path from `first_part` on. A list of images is a file, whose name loses its extension.
std::string nameFrom(const fs::path& path, std::ptrdiff_t first_part) {
  fs::path name;
  for (auto part = std::next(path.begin(), first_part); part != path.end(); ++part) name /= *part;
  if (fs::is_regular_file(path)) name.replace_extension();
  return nameOf(name.string());
}

std::vector<fs::path> matchesOf(const fs::path& pattern) {
  glob_t found{};
  std::vector<fs::path> matches;
  if (::glob(pattern.c_str(), GLOB_BRACE, nullptr, &found) == 0)
    for (std::size_t i = 0; i < found.gl_pathc; ++i) matches.emplace_back(found.gl_pathv[i]);
  ::globfree(&found);
  // A pattern with an extension finds lists of images; without one, drives are folders.
  if (!pattern.has_extension()) std::erase_if(matches, [](const fs::path& match) { return !fs::is_directory(match); });
  std::ranges::sort(matches, NaturalOrder{});
  return matches;
}

std::vector<FoundDrive> matchingDrives(const ManifestEntry& entry, const fs::path& pattern) {
  if (!entry.name.empty())
    throw UsageError(entry.where + ": 'name' is for one drive, and 'path' is a pattern of several; leave it out");
  const auto first_part = partsBeforeWildcard(pattern);
  std::vector<FoundDrive> drives;
  for (const fs::path& match : matchesOf(pattern)) drives.push_back({nameFrom(match, first_part), match});
  if (drives.empty())
    drives.push_back(
        {nameFrom(pattern, first_part), pattern, pattern.string() + ": no folder matches this pattern", true});
  return drives;
}

std::vector<FoundDrive> drivesAt(const ManifestEntry& entry, const std::string& place, const fs::path& root) {
  fs::path path = (root / expandedPath(place)).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  if (hasWildcard(place)) return matchingDrives(entry, path);
  FoundDrive drive{
      .name = entry.name.empty() ? nameFrom(path, std::distance(path.begin(), path.end()) - 1) : entry.name,
      .path = path};
  std::error_code none;
  drive.missing = !fs::exists(path, none);
  if (drive.missing) drive.problem = path.string() + ": there is no such drive";
  return {drive};
}

}  // namespace

std::vector<FoundDrive> findDrives(const ManifestEntry& entry, const fs::path& root) {
  if (!entry.scene.empty()) return {{.name = entry.name.empty() ? nameOf(entry.scene) : entry.name}};
  auto drives = drivesAt(entry, entry.path, root);
  for (const std::string& place : entry.other_paths) {
    if (!drives.front().missing) break;
    auto others = drivesAt(entry, place, root);
    if (!others.front().missing) return others;
    drives.front().problem += ", nor at " + others.front().path.string();
  }
  return drives;
}

}  // namespace motorcade
