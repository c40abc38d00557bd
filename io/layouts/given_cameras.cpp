#include "io/layouts/given_cameras.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/images/image_file.hpp"
#include "io/layouts/layout_cameras.hpp"
#include "io/layouts/layout_parts.hpp"
#include "io/rig/rig_file.hpp"
#include "io/rig/yaml_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

std::optional<double> positiveNumber(std::string_view text) {
  constexpr double kMost = 1e6;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value > 0) || value > kMost) return std::nullopt;
  return value;
}

std::vector<std::string> partsOf(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream rest(text);
  for (std::string part; std::getline(rest, part, ',');) parts.push_back(part);
  return parts;
}

StereoCamera cameraOf(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& part : partsOf(text))
    if (const auto number = positiveNumber(part)) numbers.push_back(*number);
  if (numbers.size() != 5 || partsOf(text).size() != 5)
    throw UsageError("--camera " + text +
                     ": write fx,fy,cx,cy,baseline, five positive numbers in pixels and, the last, in meters, as "
                     "718.9,718.9,607.2,185.2,0.54");
  return {.fx_px = numbers[0], .fy_px = numbers[1], .cx_px = numbers[2], .cy_px = numbers[3], .baseline_m = numbers[4]};
}

/// One file, or two with a comma between them.
std::vector<fs::path> calibrationFiles(const std::string& text) {
  if (fs::exists(text)) return {text};
  const auto parts = partsOf(text);
  return {parts.begin(), parts.end()};
}

/// Reads the camera from a calibration in a folder, whatever its name.
StereoCamera cameraInFolder(Sequence& sequence, const fs::path& folder, ImageSize size) {
  if (const auto camera = cameraIn(sequence, folder, {.any_pair = true, .names = RigNames::kAny}, size)) return *camera;
  if (fs::exists(folder / "calib_cam_to_cam.txt"))
    return cameraByKitti(sequence, readRawCalibration(folder), /*any_pair=*/true, size);
  if (const fs::path file = folder / "perspective.txt"; fs::exists(file))
    return cameraByKitti(sequence, readCalibration(file), /*any_pair=*/true, size);
  throw InputError(folder.string() +
                   ": holds no calibration of a pair that is understood (*.yaml, *.yml, *.json, *.xml, or calib.txt in "
                   "KITTI's form); name the file, or two as LEFT,RIGHT");
}

}  // namespace

GivenCameras absolute(const GivenCameras& given) {
  GivenCameras result{.camera = given.camera, .bayer = given.bayer};
  if (given.calibration.empty()) return result;
  for (const fs::path& file : calibrationFiles(given.calibration)) {
    if (!result.calibration.empty()) result.calibration += ',';
    result.calibration += fs::absolute(file).lexically_normal().string();
  }
  return result;
}

StereoCamera givenCamera(Sequence& sequence, const GivenCameras& given, ImageSize size) {
  if (!given.camera.empty() && !given.calibration.empty())
    throw UsageError("--camera and --calibration: give one of them");
  if (!given.camera.empty()) return cameraOf(given.camera);
  const auto files = calibrationFiles(given.calibration);
  if (files.size() != 1) return rectifiedCamera(sequence, readRig(files), size);
  if (fs::is_directory(files.front())) return cameraInFolder(sequence, files.front(), size);
  if (files.front().extension() == ".txt")
    return cameraByKitti(sequence, readCalibration(files.front()), /*any_pair=*/true, size);
  return rectifiedCamera(sequence, readRig(files), size);
}

namespace {

constexpr StereoSide kSides[] = {StereoSide::kLeft, StereoSide::kRight};

/// Empty for an image that cannot be read: its frame will be rejected.
std::optional<ImageHeader> headerOf(const std::filesystem::path& file) {
  try {
    return readImageHeader(file);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// The header of the first image of a side that can be read stands for all.
std::optional<ImageHeader> firstHeader(const Sequence& sequence, StereoSide side) {
  for (const FramePaths& frame : sequence.frames)
    if (const auto header = headerOf(frame.of(side))) return header;
  return std::nullopt;
}

bool isDeep(const std::optional<ImageHeader>& header) { return header && header->bits == kAllSampleBits; }

/// The first pair, the last one, and some between.
std::vector<std::size_t> pairsToLookAt(std::size_t count) {
  constexpr std::size_t kPairs = 5;
  std::vector<std::size_t> pairs;
  for (std::size_t i = 0; i < kPairs; ++i) pairs.push_back(i * (count - 1) / (kPairs - 1));
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

/// Gathers the significant bits, the maximum and the brightest sample of the inspected images.
class Samples {
 public:
  void add(const std::filesystem::path& file) {
    const auto header = headerOf(file);
    if (!isDeep(header)) return;
    told_bits_ = std::max(told_bits_, header->told_bits);
    whites_agree_ = whites_agree_ && header->white != 0 && (white_ == 0 || white_ == header->white);
    white_ = header->white;
    try {
      brightest_ = std::max(brightest_, readBrightestSample(file));
    } catch (const InputError&) {
      return;  // a damaged one
    }
  }
  SampleUse use() const {
    if (whites_agree_ && white_ != 0)
      return {kAllSampleBits, "scaled by the maximum that the files tell, " + std::to_string(white_)};
    const int bits = usedSampleBits(told_bits_, brightest_);
    const std::string brightest = "the brightest sample that was looked at is " + std::to_string(brightest_);
    if (bits == kAllSampleBits) return {bits, "their upper eight bits are used: " + brightest};
    return {bits, "taken as " + std::to_string(bits) +
                      " bits: " + (bits == told_bits_ ? "the files tell so (sBIT)" : brightest)};
  }

 private:
  int told_bits_ = 0, brightest_ = 0, white_ = 0;
  bool whites_agree_ = true;
};

}  // namespace

std::optional<SampleUse> sampleUseOf(const Sequence& sequence) {
  if (std::ranges::none_of(kSides, [&](StereoSide side) { return isDeep(firstHeader(sequence, side)); }))
    return std::nullopt;
  Samples samples;
  for (const std::size_t pair : pairsToLookAt(sequence.frames.size()))
    for (const StereoSide side : kSides) samples.add(sequence.frames[pair].of(side));
  return samples.use();
}

std::optional<BayerPattern> toldMosaic(const std::filesystem::path& calibration) {
  if (calibration.extension() != ".yaml" && calibration.extension() != ".yml") return std::nullopt;
  const YamlPart root = YamlPart::ofFile(calibration);
  const std::initializer_list<std::string_view> keys{"bayer_pattern", "bayer"};
  auto told = root.find(keys);
  if (const auto left = root.find({"cam0"}); left && !told) told = left->find(keys);
  if (!told) return std::nullopt;
  const auto pattern = bayerPatternOf(told->text());
  if (!pattern) told->fail("is " + printable(told->text()) + ", write RGGB, BGGR, GRBG or GBRG, or leave it out");
  return pattern;
}

std::optional<BayerPattern> mosaicOf(const Sequence& sequence, const GivenCameras& given) {
  const auto pattern = given.bayer.empty() ? sequence.bayer : bayerPatternOf(given.bayer);
  if (!given.bayer.empty() && !pattern)
    throw UsageError("--bayer " + given.bayer +
                     ": write RGGB, BGGR, GRBG or GBRG, the filters of the first two pixels of the first two rows");
  for (const StereoSide side : kSides) {
    const auto header = pattern ? firstHeader(sequence, side) : std::nullopt;
    if (header && header->channels != 1) throw InputError(sequence.frames.front().of(side).string() + kNoMosaic);
  }
  return pattern;
}

}  // namespace motorcade
