#include <algorithm>

#include "io/files/errors.hpp"
#include "io/layouts/layout_cameras.hpp"
#include "io/layouts/layout_parts.hpp"
#include "io/sequence/timestamps.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// Sets the camera and the stamps of a sequence whose folders are known; `calibration` reads the layout's own.
template <class Calibrate>
void finish(Sequence& sequence, const SequenceSource& source, const fs::path& times_file, Calibrate&& calibration) {
  setCamera(sequence, source.given,
            [&](ImageSize size) { return cameraByKitti(sequence, calibration(), /*any_pair=*/false, size); });
  setStamps(sequence, times_file, source.fps_hz);
}

/// The right images of the tracking set are an archive of their own.
void requireRightArchive(const fs::path& root, const fs::path& right) {
  const bool tracking = fs::exists(root / "calib" / (right.filename().string() + ".txt"));
  if (tracking && right.parent_path().filename() == "image_03" && !fs::exists(right))
    throw InputError(right.string() + ": is missing; unpack the right images of KITTI tracking, too " +
                     "(data_tracking_image_3.zip)");
}

}  // namespace

std::optional<Sequence> openKittiRaw(const SequenceSource& source) {
  const fs::path& folder = source.path;
  for (const auto& names : kPairs) {
    const fs::path left = folder / names.left, right = folder / names.right;
    if (!fs::is_directory(left / "data") || !fs::is_directory(right / "data")) continue;
    Sequence sequence{.folder = folder, .layout = "raw", .pair = names.pair};
    const fs::path times = ifExists(left / "timestamps.txt");
    sequence.truth = {.oxts = ifExists(folder / "oxts" / "data"),
                      .oxts_timestamps = ifExists(folder / "oxts" / "timestamps.txt"),
                      .image_timestamps = times};
    setFrames(sequence, left / "data", right / "data");
    finish(sequence, source, times, [&] {
      const fs::path date = folder.parent_path();
      neededFile(date / "calib_cam_to_cam.txt", "a raw drive needs the calibration of its date beside it");
      return readRawCalibration(date);
    });
    return sequence;
  }
  return std::nullopt;
}

std::optional<Sequence> openKittiTracking(const SequenceSource& source) {
  const fs::path& folder = source.path;
  const fs::path name = folder.filename();
  for (const fs::path& root : {folder.parent_path().parent_path(), folder.parent_path()}) {
    for (const auto& names : kPairs) {
      const fs::path left = root / names.left / name, right = root / names.right / name;
      if (name.empty() || !fs::is_directory(left)) continue;
      requireRightArchive(root, right);
      if (!fs::is_directory(right)) continue;
      const fs::path text = name.string() + ".txt";
      Sequence sequence{.folder = folder, .layout = "tracking", .pair = names.pair};
      sequence.truth = {.poses = ifExists(root / "poses" / text),
                        .labels = ifExists(root / "label_02" / text),
                        .oxts = ifExists(root / "oxts" / text)};
      setFrames(sequence, left, right);
      finish(sequence, source, ifExists(root / "times" / text), [&] {
        return readCalibration(neededFile(root / "calib" / text, "a tracking sequence needs its calibration"));
      });
      return sequence;
    }
  }
  return std::nullopt;
}

/// The times of all frames are in one file, a line for each number; images may begin later and have gaps.
std::optional<Sequence> openKitti360(const SequenceSource& source) {
  const fs::path& folder = source.path;
  const fs::path left = folder / "image_00" / "data_rect", right = folder / "image_01" / "data_rect";
  if (!fs::is_directory(left) || !fs::is_directory(right)) return std::nullopt;
  const fs::path root = folder.parent_path().parent_path();
  Sequence sequence{.folder = folder, .layout = "kitti360"};
  sequence.truth.numbered_poses = ifExists(root / "data_poses" / folder.filename() / "cam0_to_world.txt");
  const std::vector<std::int64_t> numbers =
      setKeyedFrames(sequence, {.left = imagesByNumber(left), .right = imagesByNumber(right)});
  const fs::path times = ifExists(folder / "image_00" / "timestamps.txt");
  finish(sequence, source, {}, [&] {
    return readCalibration(neededFile(root / "calibration" / "perspective.txt",
                                      "unpack KITTI-360's calibration beside data_2d_raw, or give --calibration"));
  });
  if (times.empty()) return sequence;
  const auto all = readTimestamps(times);
  if (numbers.back() >= std::ssize(all))
    throw InputError(times.string() + ": has " + std::to_string(all.size()) + " times; image " +
                     std::to_string(numbers.back()) + " needs a line of its own, counted from 0");
  std::ranges::transform(numbers, sequence.stamps.begin(), [&](std::int64_t number) { return all[number]; });
  sequence.stamps_measured = true;
  return sequence;
}

}  // namespace motorcade
