#include "apps/tasks/fingerprint.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
// The part of xxHash that is wanted goes into this source alone: no library of it is linked.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "io/files/errors.hpp"
#include "io/files/file_names.hpp"
#include "io/files/text_file.hpp"
#include "io/rig/rectification.hpp"

namespace motorcade {

namespace fs = std::filesystem;

struct Fingerprint::State {
  XXH3_state_t hash{};
};

Fingerprint::Fingerprint() : state_(std::make_unique<State>()) { XXH3_128bits_reset(&state_->hash); }
Fingerprint::~Fingerprint() = default;

void Fingerprint::add(std::string_view text) {
  const std::uint64_t length = text.size();
  XXH3_128bits_update(&state_->hash, &length, sizeof(length));
  XXH3_128bits_update(&state_->hash, text.data(), text.size());
}

void Fingerprint::add(double number) { XXH3_128bits_update(&state_->hash, &number, sizeof(number)); }

void Fingerprint::addFile(const fs::path& file) {
  struct stat status {};
  add(file.filename().string());
  if (::stat(file.c_str(), &status) != 0) return add("is not there");
  for (const auto value : {static_cast<std::int64_t>(status.st_size), static_cast<std::int64_t>(status.st_mtim.tv_sec),
                           static_cast<std::int64_t>(status.st_mtim.tv_nsec)})
    XXH3_128bits_update(&state_->hash, &value, sizeof(value));
}

std::string Fingerprint::text() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(&state_->hash);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string fileStamp(const fs::path& file) {
  Fingerprint fingerprint;
  fingerprint.addFile(file);
  return fingerprint.text();
}

std::string programFingerprint(const fs::path& program) {
  Fingerprint fingerprint;
  try {
    fingerprint.add(readWhole(program));
    for (const fs::path& module : listFolderIfThere(program.parent_path() / "motorcade"))
      if (fs::is_regular_file(module)) fingerprint.add(readWhole(module));
  } catch (const InputError& error) {
    throw UsageError("the program of the tasks: " + std::string(error.what()));
  }
  return fingerprint.text();
}

namespace {

void addLens(Fingerprint& fingerprint, const LensCamera& lens) {
  for (const double number : {lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px}) fingerprint.add(number);
  fingerprint.add(static_cast<double>(lens.distortion));
  for (const double coefficient : lens.coefficients) fingerprint.add(coefficient);
}

}  // namespace

std::string sequenceFingerprint(const Sequence& sequence) {
  Fingerprint fingerprint;
  fingerprint.add(sequence.layout);
  const StereoCamera& camera = sequence.camera;
  for (const double number : {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px, camera.baseline_m})
    fingerprint.add(number);
  if (sequence.rectification) {
    addLens(fingerprint, sequence.rectification->left);
    addLens(fingerprint, sequence.rectification->right);
    for (const auto* rotation : {&sequence.rectification->R_left, &sequence.rectification->R_right})
      for (const double number : rotation->reshaped()) fingerprint.add(number);
  }
  if (sequence.bayer) fingerprint.add(std::string(nameOf(*sequence.bayer)));
  for (const FramePaths& frame : sequence.frames) {
    fingerprint.addFile(frame.left);
    fingerprint.addFile(frame.right);
  }
  const Sequence::Truth& truth = sequence.truth;
  for (const fs::path& file :
       {truth.poses, truth.labels, truth.object_poses, truth.instances, truth.oxts, truth.oxts_timestamps,
        truth.image_timestamps, truth.stamped_poses, truth.numbered_poses})
    if (!file.empty()) fingerprint.addFile(file);
  if (!truth.virtual_kitti.empty())
    for (const char* const name : {"intrinsic.txt", "extrinsic.txt", "pose.txt", "bbox.txt", "info.txt"})
      fingerprint.addFile(truth.virtual_kitti / name);
  return fingerprint.text();
}

}  // namespace motorcade
