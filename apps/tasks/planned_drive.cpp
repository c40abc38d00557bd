#include "apps/tasks/planned_drive.hpp"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string_view>
#include <thread>

#include "apps/synth/synth_command.hpp"
#include "apps/tasks/fingerprint.hpp"
#include "apps/tasks/path_text.hpp"
#include "io/files/errors.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/sequence/sequence.hpp"
#include "io/truth/ground_truth.hpp"

namespace motorcade {

namespace fs = std::filesystem;

namespace {
constexpr std::string_view kFramesOfTruth = "truth";  // in place of a range
}  // namespace

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

namespace {

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
