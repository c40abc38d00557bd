#include "io/layouts/layout_parts.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "io/files/errors.hpp"
#include "io/files/file_names.hpp"
#include "io/images/image_file.hpp"
#include "io/layouts/given_cameras.hpp"
#include "io/layouts/unsupported.hpp"
#include "io/rig/rectification.hpp"
#include "io/rig/rig_search.hpp"
#include "io/sequence/frame_lines.hpp"
#include "io/sequence/pairing.hpp"
#include "io/sequence/timestamps.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// The size that the images agree on, from the first header that can be read in each folder.
ImageSize imageSize(const Sequence& sequence) {
  const auto firstSize = [&](StereoSide side) -> std::optional<ImageSize> {
    for (const auto& frame : sequence.frames) {
      if (frame.isMissing(side)) continue;
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

/// Sets the times of frames by their places in the numbering.
void setStampsByRate(Sequence& sequence, double fps_hz) {
  if (!(fps_hz > 0) || !std::isfinite(fps_hz)) throw UsageError("--fps must be a positive number");
  for (std::size_t i = 0; i < sequence.frames.size(); ++i)
    sequence.stamps.push_back(stampAtRate(placeOf(sequence, i), fps_hz));
}

}  // namespace

fs::path ifExists(const fs::path& file) { return fs::exists(file) ? file : fs::path(); }

fs::path neededFile(const fs::path& file, const std::string& why) {
  if (!fs::exists(file)) throw InputError(file.string() + ": is missing; " + why);
  return file;
}

std::vector<fs::path> listImages(const fs::path& folder) {
  std::vector<fs::path> images = listFolder(folder);
  std::erase_if(images, [](const fs::path& file) {
    if (!fs::is_regular_file(file) || file.filename().string().starts_with('.')) return true;
    return !hasImageName(file) && imageFormat(file) == ImageFormat::kUnknown;
  });
  return images;
}

std::vector<fs::path> imagesIn(const fs::path& folder) {
  auto images = listImages(folder);
  if (!images.empty()) return images;
  const auto others = otherImages(folder);
  throw InputError(folder.string() + ": holds no PNG, JPEG or PGM image" +
                   (others.empty() ? "" : "; " + adviceOnOtherImages(others)));
}

ImagesByNumber imagesByNumber(const fs::path& folder) {
  ImagesByNumber by_number;
  for (const fs::path& image : imagesIn(folder))
    if (const auto number = imageNumber(image)) by_number.emplace(*number, image);
  return by_number;
}

void setFrames(Sequence& sequence, const fs::path& left_folder, const fs::path& right_folder) {
  setPairs(sequence, pairImages(namedImages(imagesIn(left_folder)), namedImages(imagesIn(right_folder))));
}

std::vector<std::int64_t> setKeyedFrames(Sequence& sequence, const KeyedImages& images) {
  const auto named = [](const ImagesByNumber& side) {
    std::vector<fs::path> files;
    for (const auto& [number, image] : side) files.push_back(image);
    return namedImages(files);
  };
  if (images.left.empty() || images.right.empty())
    throw InputError(sequence.folder.string() + ": the names of the images tell no number or time");
  PairedImages paired = pairByKeys(images, named(images.left), named(images.right));
  leaveOutEnds(paired);
  const std::vector<std::int64_t> numbers = paired.numbers;
  setPairs(sequence, std::move(paired));
  return numbers;
}

void tellUnit(Sequence& sequence, const Times& times, const fs::path& file) {
  if (times.unit_ns == 1'000'000'000) return;
  sequence.notes.push_back({"times", file.string() + ": its numbers are taken as " + unitName(times.unit_ns) +
                                         ", as no camera takes images so many seconds apart"});
}

void setStamps(Sequence& sequence, const fs::path& times_file, double fps_hz) {
  if (!times_file.empty()) {
    const Times times = readTimes(times_file);
    setStampsOfLines(sequence, times.stamps, times_file);
    sequence.stamps_measured = true;
    tellUnit(sequence, times, times_file);
  } else if (sequence.stamps.empty()) {
    setStampsByRate(sequence, fps_hz);
  }
  tellPeriod(sequence);
}

StereoCamera rectifiedCamera(Sequence& sequence, const Rig& rig, ImageSize size) {
  const Rectification rectification = rectificationOf(rig, size);
  if (!rig.rectified) sequence.rectification = std::make_shared<const Rectification>(rectification);
  sequence.calibrated_by = joinedFiles(rig.files);
  sequence.calibration_remark = rig.remark;
  sequence.bayer = toldMosaic(rig.file);
  return rectification.camera;
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
