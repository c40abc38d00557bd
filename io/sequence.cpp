#include "io/sequence.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "io/errors.hpp"
#include "io/image_file.hpp"
#include "io/timestamps.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

struct PairNames {
  const char *left, *right;
  CameraPair pair;
};
constexpr std::array kPairs = {
    PairNames{"image_0", "image_1", CameraPair::kGray}, PairNames{"image_00", "image_01", CameraPair::kGray},
    PairNames{"left", "right", CameraPair::kGray}, PairNames{"image_2", "image_3", CameraPair::kColor},
    PairNames{"image_02", "image_03", CameraPair::kColor}};

fs::path ifExists(const fs::path& file) { return fs::exists(file) ? file : fs::path(); }

/// Images in a folder, by name. A file counts by its content, or by its name when the content is damaged.
std::vector<fs::path> listImages(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path().filename().string().starts_with('.')) continue;
    if (hasImageName(entry.path()) || imageFormat(entry.path()) != ImageFormat::kUnknown)
      images.push_back(entry.path());
  }
  std::ranges::sort(images);
  return images;
}

/// The name of an image of `some` that has no partner of the same name among `others`.
std::optional<fs::path> withoutPartner(const std::vector<fs::path>& some, const std::vector<fs::path>& others) {
  for (const auto& image : some) {
    const auto same_name = [&](const fs::path& other) { return other.stem() == image.stem(); };
    if (std::ranges::none_of(others, same_name)) return image;
  }
  return std::nullopt;
}

std::vector<FramePaths> pairImages(const fs::path& left_folder, const fs::path& right_folder) {
  const auto left = listImages(left_folder), right = listImages(right_folder);
  if (left.empty()) throw InputError(left_folder.string() + ": holds no PNG, JPEG or PGM image");
  if (right.empty()) throw InputError(right_folder.string() + ": holds no PNG, JPEG or PGM image");
  if (left.size() != right.size()) {
    auto alone = left.size() > right.size() ? withoutPartner(left, right) : withoutPartner(right, left);
    throw InputError(left_folder.string() + " holds " + std::to_string(left.size()) + " images, " +
                     right_folder.string() + " holds " + std::to_string(right.size()) +
                     (alone ? ": " + alone->string() + " has no partner" : "") +
                     "; every left image needs a right one");
  }
  const bool by_name = left.front().stem() == right.front().stem() || left.back().stem() == right.back().stem();
  std::vector<FramePaths> frames;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (by_name && left[i].stem() != right[i].stem()) {
      throw InputError(left[i].string() + ": has no partner of the same name in " + right_folder.string());
    }
    frames.push_back({left[i], right[i]});
  }
  return frames;
}

/// The size that the images agree on, from the first header that can be read in each folder.
void setImageSize(Sequence& sequence) {
  const auto firstSize = [&](auto side) -> std::optional<ImageSize> {
    for (const auto& frame : sequence.frames) {
      try {
        return readImageSize(frame.*side);
      } catch (const InputError&) {
        continue;  // this frame will be rejected when its turn comes
      }
    }
    return std::nullopt;
  };
  const auto left = firstSize(&FramePaths::left), right = firstSize(&FramePaths::right);
  if (!left) readImageSize(sequence.frames.front().left);  // throws, and says why
  if (!right) readImageSize(sequence.frames.front().right);
  if (*left != *right) {
    throw InputError(sequence.frames.front().left.string() + " has " + left->text() + " pixels, " +
                     sequence.frames.front().right.string() + " has " + right->text() +
                     ": a rectified pair has equal sizes");
  }
  sequence.camera.width_px = left->width;
  sequence.camera.height_px = left->height;
}

void setStamps(Sequence& sequence, const fs::path& times_file, double fps_hz) {
  if (!times_file.empty()) {
    sequence.stamps = readTimestamps(times_file);
    sequence.stamps_measured = true;
    if (sequence.stamps.size() != sequence.frames.size()) {
      throw InputError(times_file.string() + ": has " + std::to_string(sequence.stamps.size()) + " times for " +
                       std::to_string(sequence.frames.size()) + " images; one line per image is needed");
    }
    return;
  }
  if (!(fps_hz > 0) || !std::isfinite(fps_hz)) throw UsageError("--fps must be a positive number");
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    sequence.stamps.push_back({static_cast<std::int64_t>(std::llround(static_cast<double>(i) * 1e9 / fps_hz))});
  }
}

/// What is common to all layouts once the folders are known.
void finish(Sequence& sequence, const fs::path& left, const fs::path& right, const fs::path& times_file,
            double fps_hz) {
  sequence.frames = pairImages(left, right);
  sequence.camera = sequence.calibration.stereoCamera(sequence.pair);
  setImageSize(sequence);
  setStamps(sequence, times_file, fps_hz);
}

fs::path neededFile(const fs::path& file, const std::string& why) {
  if (!fs::exists(file)) throw InputError(file.string() + ": is missing; " + why);
  return file;
}

std::optional<Sequence> openRaw(const fs::path& folder, double fps_hz) {
  for (const auto& names : kPairs) {
    const fs::path left = folder / names.left, right = folder / names.right;
    if (!fs::is_directory(left / "data") || !fs::is_directory(right / "data")) continue;
    const fs::path date = folder.parent_path();
    neededFile(date / "calib_cam_to_cam.txt", "a raw drive needs the calibration of its date beside it");
    Sequence sequence{.folder = folder, .layout = "raw", .pair = names.pair, .calibration = readRawCalibration(date)};
    const fs::path times = ifExists(left / "timestamps.txt");
    sequence.truth = {.oxts = ifExists(folder / "oxts" / "data"),
                      .oxts_timestamps = ifExists(folder / "oxts" / "timestamps.txt"),
                      .image_timestamps = times};
    finish(sequence, left / "data", right / "data", times, fps_hz);
    return sequence;
  }
  return std::nullopt;
}

std::optional<Sequence> openTracking(const fs::path& folder, double fps_hz) {
  const fs::path name = folder.filename();
  for (const fs::path& root : {folder.parent_path().parent_path(), folder.parent_path()}) {
    for (const auto& names : kPairs) {
      const fs::path left = root / names.left / name, right = root / names.right / name;
      if (name.empty() || !fs::is_directory(left) || !fs::is_directory(right)) continue;
      const fs::path text = name.string() + ".txt";
      Sequence sequence{.folder = folder, .layout = "tracking", .pair = names.pair};
      sequence.calibration =
          readCalibration(neededFile(root / "calib" / text, "a tracking sequence needs its calibration"));
      sequence.truth = {.poses = ifExists(root / "poses" / text),
                        .labels = ifExists(root / "label_02" / text),
                        .oxts = ifExists(root / "oxts" / text)};
      finish(sequence, left, right, ifExists(root / "times" / text), fps_hz);
      return sequence;
    }
  }
  return std::nullopt;
}

std::optional<Sequence> openPlain(const fs::path& folder, double fps_hz) {
  for (const auto& names : kPairs) {
    const fs::path left = folder / names.left, right = folder / names.right;
    if (!fs::is_directory(left) || !fs::is_directory(right)) continue;
    Sequence sequence{.folder = folder, .layout = "plain", .pair = names.pair};
    sequence.calibration =
        readCalibration(neededFile(folder / "calib.txt", "write the lines P0 and P1 of KITTI's calibration into it"));
    const bool any_pair = std::string_view(names.left) == "left";  // such folders may give either pair of keys
    if (any_pair && !sequence.calibration.P[0]) sequence.pair = CameraPair::kColor;
    fs::path poses = ifExists(folder / "poses.txt");
    if (poses.empty()) {
      poses = ifExists(folder.parent_path().parent_path() / "poses" / (folder.filename().string() + ".txt"));
      if (!poses.empty()) sequence.layout = "odometry";
    }
    sequence.truth = {.poses = poses,
                      .labels = ifExists(folder / "label_02.txt"),
                      .object_poses = ifExists(folder / "object_poses.txt"),
                      .instances = ifExists(folder / "instance"),
                      .oxts = ifExists(folder / "oxts.txt"),
                      .oxts_timestamps = ifExists(folder / "oxts_timestamps.txt"),
                      .image_timestamps = ifExists(folder / "image_timestamps.txt")};
    finish(sequence, left, right, ifExists(folder / "times.txt"), fps_hz);
    return sequence;
  }
  return std::nullopt;
}

}  // namespace

FrameRange parseFrameRange(std::string_view text) {
  const auto colon = text.find(':');
  const auto bad = [&] {
    return UsageError("--frames " + std::string(text) + ": write A:B, the first frame and the one after the last");
  };
  if (colon == std::string_view::npos) throw bad();
  const auto parse = [&](std::string_view part, std::size_t when_empty) {
    if (part.empty()) return when_empty;
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size()) throw bad();
    return value;
  };
  const FrameRange everything;
  const FrameRange range{parse(text.substr(0, colon), everything.begin), parse(text.substr(colon + 1), everything.end)};
  if (range.size() == 0) throw bad();
  return range;
}

Sequence openSequence(const fs::path& given, double fps_hz) {
  // Parents are looked at, so "." and a slash at the end must go.
  fs::path folder = fs::absolute(given).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  try {
    if (auto raw = openRaw(folder, fps_hz)) return *std::move(raw);
    if (auto tracking = openTracking(folder, fps_hz)) return *std::move(tracking);
    if (auto plain = openPlain(folder, fps_hz)) return *std::move(plain);
  } catch (const fs::filesystem_error& error) {
    throw InputError(error.path1().string() + ": " + error.code().message());
  }
  if (!fs::exists(folder)) throw InputError(given.string() + ": does not exist");
  throw InputError(given.string() +
                   ": holds no stereo sequence; two folders image_0 + image_1, image_2 + image_3, image_02 + image_03 "
                   "or left + right "
                   "with a calib.txt beside them, or a KITTI tracking, odometry or raw folder, are understood");
}

FrameRange selectedFrames(std::string_view text, const Sequence& sequence) {
  const FrameRange range = (text.empty() ? FrameRange{} : parseFrameRange(text)).within(sequence.frames.size());
  if (range.size() == 0)
    throw UsageError("--frames " + std::string(text) + ": the sequence has " + std::to_string(sequence.frames.size()) +
                     " frames, none of these");
  return range;
}

}  // namespace motorcade
