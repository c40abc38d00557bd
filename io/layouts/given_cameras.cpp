#include "io/layouts/given_cameras.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "io/files/errors.hpp"
#include "io/layouts/layout_cameras.hpp"
#include "io/layouts/layout_parts.hpp"
#include "io/rig/rig_file.hpp"

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

}  // namespace motorcade
