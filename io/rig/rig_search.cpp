#include "io/rig/rig_search.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <set>

#include "io/files/file_names.hpp"
#include "io/rig/rig_file.hpp"
#include "io/rig/rig_readers.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

using Files = std::vector<fs::path>;

/// A calibration in a folder, and its pair; none where it cannot be used.
struct Candidate {
  Files files;
  std::optional<Rig> rig{};
};

std::string lowered(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::set<fs::path> filesOf(const fs::path& folder) {
  constexpr std::array kExtensions{".yaml", ".yml", ".json", ".xml"};
  constexpr std::uintmax_t kMost_bytes = std::uintmax_t{1} << 20;  // larger ones are no calibrations
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = lowered(entry.path().extension().string());
    if (std::ranges::find(kExtensions, extension) != kExtensions.end() && entry.is_regular_file() &&
        entry.file_size() <= kMost_bytes)
      files.insert(entry.path());
  }
  return files;
}

/// The same name with one of two words exchanged for the other; empty where it has neither.
fs::path partnerOf(const fs::path& file, const std::string& word, const std::string& other) {
  std::string name = file.filename().string();
  const std::size_t found = name.rfind(word);
  return found == std::string::npos ? fs::path() : file.parent_path() / name.replace(found, word.size(), other);
}

/// Files that belong together by their names.
std::vector<Files> pairsOf(const std::set<fs::path>& files) {
  constexpr std::array<std::pair<const char*, const char*>, 5> kWords{
      {{"left", "right"}, {"Left", "Right"}, {"LEFT", "RIGHT"}, {"intrinsics", "extrinsics"}, {"cam0", "cam1"}}};
  std::vector<Files> pairs;
  for (const fs::path& file : files)
    for (const auto& [first, second] : kWords)
      if (const fs::path partner = partnerOf(file, first, second); files.contains(partner))
        pairs.push_back({file, partner});
  return pairs;
}

bool hasUsualName(const fs::path& file) {
  constexpr std::array kWords{"camchain", "stereo", "calib"};
  const std::string name = lowered(file.stem().string());
  return std::ranges::any_of(kWords, [&](const char* word) { return name.find(word) != std::string::npos; });
}

/// Files that may be calibrations, in the order in which they are tried.
std::vector<Files> filesInQuestion(const fs::path& folder, RigNames names) {
  const auto files = filesOf(folder);
  std::vector<Files> all = pairsOf(files);
  if (const fs::path left = folder / "cam0/sensor.yaml", right = folder / "cam1/sensor.yaml";
      fs::exists(left) && fs::exists(right))
    all.push_back({left, right});
  for (const fs::path& file : files)
    if (names == RigNames::kAny || hasUsualName(file)) all.push_back({file});
  return all;
}

/// Nothing where the files are no calibration of a pair.
std::optional<Candidate> candidateOf(const Files& files) {
  try {
    return Candidate{files, readRig(files)};
  } catch (const UnknownCalibration&) {
    return std::nullopt;
  } catch (const OneCameraError&) {
    return std::nullopt;
  } catch (const InputError&) {
    return Candidate{files};
  }
}

bool isClose(double a, double b) { return std::abs(a - b) <= 1e-6 * std::max(1.0, std::abs(a)); }

bool isSame(const LensCamera& a, const LensCamera& b) {
  return a.distortion == b.distortion && isClose(a.fx_px, b.fx_px) && isClose(a.fy_px, b.fy_px) &&
         isClose(a.cx_px, b.cx_px) && isClose(a.cy_px, b.cy_px) &&
         std::ranges::equal(a.coefficients, b.coefficients, isClose);
}

bool isSame(const StereoCamera& a, const StereoCamera& b) {
  return isClose(a.fx_px, b.fx_px) && isClose(a.fy_px, b.fy_px) && isClose(a.cx_px, b.cx_px) &&
         isClose(a.cy_px, b.cy_px) && isClose(a.baseline_m, b.baseline_m);
}

bool isSame(const Rectification& a, const Rectification& b) {
  constexpr double kRounded = 1e-6;
  return isSame(a.camera, b.camera) && a.R_left.isApprox(b.R_left, kRounded) && a.R_right.isApprox(b.R_right, kRounded);
}

bool isSame(const Rig& a, const Rig& b) {
  constexpr double kRounded = 1e-6;
  if (a.given.has_value() != b.given.has_value() || a.rectified.has_value() != b.rectified.has_value()) return false;
  if (a.rectified) return isSame(*a.rectified, *b.rectified);
  if (!isSame(a.left, b.left) || !isSame(a.right, b.right)) return false;
  return a.given ? isSame(*a.given, *b.given) : (a.T_right_left.inverse() * b.T_right_left).log().norm() < kRounded;
}

double baselineOf_m(const Rig& rig) {
  if (rig.rectified) return rig.rectified->baseline_m;
  return rig.given ? rig.given->camera.baseline_m : rig.T_right_left.translation().norm();
}

[[noreturn]] void failSeveral(const fs::path& folder, const std::vector<Candidate>& candidates) {
  std::string list;
  for (const Candidate& candidate : candidates) {
    std::array<char, 64> told{"cannot be used"};
    if (candidate.rig) std::snprintf(told.data(), told.size(), "baseline %.4f m", baselineOf_m(*candidate.rig));
    list += "\n  " + calibrationArgument(candidate.files) + "    (" + told.data() + ")";
  }
  throw InputError(folder.string() + ": holds " + std::to_string(candidates.size()) +
                   " calibrations, which differ; say which one is the cameras' by one of" + list);
}

}  // namespace

std::string joinedFiles(const std::vector<fs::path>& files) {
  std::string names;
  for (const fs::path& file : files) {
    if (!names.empty()) names += ',';
    names += file.string();
  }
  return names;
}

std::string calibrationArgument(const std::vector<fs::path>& files) {
  return "--calibration " + shellWord(joinedFiles(files));
}

std::vector<fs::path> usualRigFiles(const fs::path& folder, RigNames names) {
  std::vector<Candidate> candidates;
  for (const Files& files : filesInQuestion(folder, names))
    if (auto candidate = candidateOf(files)) candidates.push_back(*std::move(candidate));
  if (candidates.empty()) return {};
  const Candidate& first = candidates.front();
  const auto differs = [&](const Candidate& other) {
    return !first.rig || !other.rig || !isSame(*first.rig, *other.rig);
  };
  if (candidates.size() > 1 && std::any_of(candidates.begin() + 1, candidates.end(), differs))
    failSeveral(folder, candidates);
  return first.files;
}

}  // namespace motorcade
