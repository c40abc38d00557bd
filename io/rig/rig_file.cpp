#include "io/rig/rig_file.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "io/files/text_file.hpp"
#include "io/rig/rig_readers.hpp"
#include "io/rig/yaml_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// A reader of one form, and the number of files that it may have.
struct RigReader {
  std::optional<Rig> (*read)(RigParts);
  std::size_t most_files;
};

constexpr std::array kReaders{RigReader{kalibrRig, 1},   RigReader{rosRig, 2},  RigReader{openCvRig, 2},
                              RigReader{placedRig, 2},   RigReader{slamRig, 1}, RigReader{vinsRig, 1},
                              RigReader{rectifiedRig, 1}};

[[noreturn]] void failUnknown(const fs::path& file) {
  throwKnownForm(file, readWhole(file));
  throw UnknownCalibration(
      file.string() +
      ": is no calibration of a pair that is understood; give Kalibr's camchain (cam0, cam1), OpenCV's "
      "M1 D1 M2 D2 R T (or intrinsics.yml,extrinsics.yml), or ROS' camera_info as left.yaml,right.yaml");
}

}  // namespace

Rig readRig(const std::vector<fs::path>& files) {
  if (files.empty() || files.size() > 2) throw UsageError("--calibration: one file, or two with a comma between them");
  std::vector<YamlPart> parts;
  for (const fs::path& file : files) parts.push_back(YamlPart::ofFile(file));
  for (const RigReader& reader : kReaders) {
    auto rig = reader.read(RigParts(parts).first(std::min(parts.size(), reader.most_files)));
    if (!rig) continue;
    if (parts.size() > reader.most_files)
      throw InputError(files.back().string() + ": is one too many; " + files.front().string() +
                       " tells of both cameras");
    rig->files = files;
    return *std::move(rig);
  }
  failUnknown(files.front());
}

Rig readEurocRig(const fs::path& left, const fs::path& right) {
  const std::array parts{YamlPart::ofFile(left), YamlPart::ofFile(right)};
  for (const YamlPart& part : parts) part.at({"intrinsics"}), part.at({"T_BS"});
  Rig rig = placedRig(parts).value();
  rig.files = {left, right};
  return rig;
}

SE3 readEurocPlacement(const fs::path& sensor_file) { return sensorPlacement(YamlPart::ofFile(sensor_file)); }

}  // namespace motorcade
