#include "apps/tasks/planned_drive.hpp"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string_view>
#include <thread>

#include <glob.h>

#include "apps/synth/synth_command.hpp"
#include "apps/tasks/fingerprint.hpp"
#include "io/files/errors.hpp"
#include "io/files/file_names.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/sequence/sequence.hpp"
#include "io/truth/ground_truth.hpp"

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

constexpr std::string_view kFramesOfTruth = "truth";  // in place of a range

double fpsOf(const ManifestEntry& entry) {
  constexpr double kDefault_hz = 10;
  const std::string text = optionOf(entry, "fps");
  if (text.empty()) return kDefault_hz;
  char* end = nullptr;
  const double fps_hz = std::strtod(text.c_str(), &end);
  if (*end != '\0' || !(fps_hz > 0))
    throw UsageError(entry.where + ": 'fps' is " + text + "; write a positive number of pairs per second");
  return fps_hz;
}

/// The frames that the entry selects; `truth` are those with ground truth.
std::string frameRangeOf(const std::string& option, const Sequence& sequence, const std::optional<CameraTruth>& truth) {
  if (option != kFramesOfTruth) return option;
  if (!truth || truth->T_world_cam.empty()) return "";
  const std::int64_t end = std::ssize(truth->T_world_cam);
  if (truth->first_frame == 0 && end == std::ssize(sequence.frames)) return "";
  return std::to_string(truth->first_frame) + ":" + std::to_string(end);
}

/// Opens a recorded drive; an error becomes its problem.
void open(const Manifest& manifest, PlannedDrive& drive) {
  const ManifestEntry& entry = *drive.entry;
  if (!drive.found.problem.empty()) return;
  try {
    const GivenCameras given{optionOf(entry, "camera"), calibrationOption(entry, manifest.root),
                             optionOf(entry, "bayer")};
    const Sequence sequence = openSequence(drive.found.path, fpsOf(entry), given);
    const auto truth = readCameraTruth(sequence);
    drive.frame_range = frameRangeOf(optionOf(entry, "frames"), sequence, truth);
    drive.frames = static_cast<std::int64_t>(selectedFrames(drive.frame_range, sequence).size());
    drive.has_truth = truth.has_value();
    drive.fingerprint = sequenceFingerprint(sequence);
  } catch (const std::exception& error) {
    drive.found.problem = error.what();
  }
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

std::string optionOf(const ManifestEntry& entry, const std::string& name) {
  const auto found = entry.options.find(name);
  return found == entry.options.end() ? "" : found->second;
}

fs::path fileOption(const ManifestEntry& entry, const std::string& name, const fs::path& root) {
  const std::string file = optionOf(entry, name);
  return file.empty() ? fs::path() : (root / expandedPath(file)).lexically_normal();
}

std::string calibrationOption(const ManifestEntry& entry, const fs::path& root) {
  const std::string given = optionOf(entry, "calibration");
  const auto comma = given.find(',');
  if (given.empty()) return "";
  std::string left = (root / expandedPath(given.substr(0, comma))).lexically_normal().string();
  if (comma == std::string::npos) return left;
  return left + "," + (root / expandedPath(given.substr(comma + 1))).lexically_normal().string();
}

void openDrives(const Manifest& manifest, std::vector<PlannedDrive>& drives) {
  constexpr std::size_t kAtATime = 16;
  std::atomic<std::size_t> next = 0;
  std::vector<std::jthread> openers;
  for (std::size_t i = 0; i < std::min(kAtATime, drives.size()); ++i)
    openers.emplace_back([&] {
      for (std::size_t drive = next++; drive < drives.size(); drive = next++)
        if (drives[drive].entry->scene.empty()) open(manifest, drives[drive]);
    });
}

void describeScene(PlannedDrive& drive, std::uint32_t seed) {
  const ManifestEntry& entry = *drive.entry;
  if (const std::string frames = optionOf(entry, "frames"); frames != kFramesOfTruth) drive.frame_range = frames;
  drive.frames = entry.length;
  drive.has_truth = true;
  const auto known = synthSceneNames();
  if (std::ranges::find(known, entry.scene) == known.end())
    drive.found.problem = entry.where + ": there is no scene '" + entry.scene + "'; see motorcade help synth";
  else if (entry.length == 0)
    drive.frames = synthSceneFrames(entry.scene, seed);
}

}  // namespace motorcade
