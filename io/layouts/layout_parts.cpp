#include "io/layouts/layout_parts.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "io/errors.hpp"
#include "io/image_file.hpp"
#include "io/layouts/given_cameras.hpp"
#include "io/layouts/sample_use.hpp"
#include "io/rig/rectification.hpp"
#include "io/timestamps.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// The name of an image of `some` that has no partner of the same name among `others`.
std::optional<fs::path> withoutPartner(const std::vector<fs::path>& some, const std::vector<fs::path>& others) {
  for (const auto& image : some) {
    const auto same_name = [&](const fs::path& other) { return other.stem() == image.stem(); };
    if (std::ranges::none_of(others, same_name)) return image;
  }
  return std::nullopt;
}

void requireImages(const fs::path& folder, const std::vector<fs::path>& images) {
  if (images.empty()) throw InputError(folder.string() + ": holds no PNG, JPEG or PGM image");
}

/// The size that the images agree on, from the first header that can be read in each folder.
ImageSize imageSize(const Sequence& sequence) {
  const auto firstSize = [&](StereoSide side) -> std::optional<ImageSize> {
    for (const auto& frame : sequence.frames) {
      try {
        return readImageSize(frame.of(side));
      } catch (const InputError&) {
        continue;  // this frame will be rejected when its turn comes
      }
    }
    return std::nullopt;
  };
  const auto left = firstSize(StereoSide::kLeft), right = firstSize(StereoSide::kRight);
  if (!left) readImageSize(sequence.frames.front().left);  // throws, and says why
  if (!right) readImageSize(sequence.frames.front().right);
  if (*left != *right) {
    throw InputError(sequence.frames.front().left.string() + " has " + left->text() + " pixels, " +
                     sequence.frames.front().right.string() + " has " + right->text() +
                     ": a stereo pair has equal sizes");
  }
  return *left;
}

}  // namespace

fs::path ifExists(const fs::path& file) { return fs::exists(file) ? file : fs::path(); }

fs::path neededFile(const fs::path& file, const std::string& why) {
  if (!fs::exists(file)) throw InputError(file.string() + ": is missing; " + why);
  return file;
}

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

std::vector<FramePaths> pairImages(const fs::path& left_folder, const fs::path& right_folder) {
  const auto left = listImages(left_folder), right = listImages(right_folder);
  requireImages(left_folder, left);
  requireImages(right_folder, right);
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

std::optional<std::int64_t> imageNumber(const fs::path& image) {
  const std::string name = image.stem().string();
  const std::size_t begin = name.find_last_not_of("0123456789") + 1;
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(name.data() + begin, name.data() + name.size(), number);
  if (begin == name.size() || error != std::errc()) return std::nullopt;
  return number;
}

ImagesByNumber imagesByNumber(const fs::path& folder) {
  const auto images = listImages(folder);
  requireImages(folder, images);
  ImagesByNumber by_number;
  for (const fs::path& image : images)
    if (const auto number = imageNumber(image)) by_number.emplace(*number, image);
  return by_number;
}

NumberedFrames pairByNumber(const ImagesByNumber& left, const ImagesByNumber& right, std::int64_t most_apart) {
  NumberedFrames pairs;
  auto partner = right.begin();
  for (const auto& [number, image] : left) {
    while (partner != right.end() && partner->first < number - most_apart) ++partner;
    if (partner == right.end()) break;
    if (partner->first > number + most_apart) continue;
    pairs.frames.push_back({image, partner->second});
    pairs.numbers.push_back(number);
    ++partner;
  }
  if (pairs.frames.empty())
    throw InputError((left.empty() ? fs::path() : left.begin()->second.parent_path()).string() +
                     ": none of the images has a partner on the other side of the same number or time");
  return pairs;
}

void setStampedFrames(Sequence& sequence, const ImagesByNumber& left, const ImagesByNumber& right) {
  NumberedFrames pairs = pairByNumber(left, right, kMostApart_ns);
  sequence.frames = std::move(pairs.frames);
  for (const std::int64_t stamp_ns : pairs.numbers) sequence.stamps.push_back({stamp_ns});
  sequence.stamps_measured = true;
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

StereoCamera rectifiedCamera(Sequence& sequence, const Rig& rig, ImageSize size) {
  sequence.rectification = std::make_shared<const Rectification>(rectificationOf(rig, size));
  sequence.bayer = toldMosaic(rig.file);
  return sequence.rectification->camera;
}

void setCamera(Sequence& sequence, const GivenCameras& given, const LayoutCamera& layouts_own) {
  const ImageSize size = imageSize(sequence);
  sequence.given = absolute(given);
  sequence.camera = given.empty() ? layouts_own(size) : givenCamera(sequence, sequence.given, size);
  sequence.camera.width_px = size.width;
  sequence.camera.height_px = size.height;
  sequence.samples = sampleUseOf(sequence);
  sequence.bayer = mosaicOf(sequence, given);
}

}  // namespace motorcade
