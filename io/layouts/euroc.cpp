#include <string>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/layouts/layout_parts.hpp"
#include "io/rig/rectification.hpp"
#include "io/rig/rig_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// The images of one camera by their times, from its table; from their names where there is none.
ImagesByNumber imagesOf(const fs::path& camera) {
  const fs::path table = camera / "data.csv";
  if (!fs::exists(table)) return imagesByNumber(camera / "data");
  ImagesByNumber images;
  std::size_t missing = 0;
  for (const TextLine& line : readLines(table)) {
    if (line.text.starts_with('#')) continue;
    FieldReader fields(table, line, ',');
    const std::int64_t stamp_ns = fields.integer("a time in nanoseconds");
    const fs::path image = camera / "data" / trimmed(fields.word("the name of an image"));
    if (fs::exists(image))
      images.emplace(stamp_ns, image);
    else
      ++missing;
  }
  if (missing > images.size())
    throw InputError(table.string() + ": names " + std::to_string(missing) + " images that are not in " +
                     (camera / "data").string() + "; is it the table of another recording?");
  if (images.empty()) throw InputError(table.string() + ": names no image that is there");
  return images;
}

/// Adds the poses of the left camera beside the recording, or of the body within it. Both are in the frame of the
/// instrument that measured them.
void addTruth(Sequence& sequence, const fs::path& mav, const fs::path& left_sensor) {
  SE3 T_left_rectified;
  if (sequence.rectification)
    T_left_rectified = SE3(sequence.rectification->R_left.transpose(), Eigen::Vector3d::Zero());
  if (const fs::path poses = ifExists(mav.parent_path() / "poses_left_camera.csv"); !poses.empty()) {
    sequence.truth.stamped_poses = poses;
    sequence.truth.T_posed_cam = T_left_rectified;
    return;
  }
  for (const char* name : {"state_groundtruth_estimate0", "mocap0"}) {
    const fs::path poses = mav / name / "data.csv";
    if (!fs::exists(poses) || !fs::exists(left_sensor)) continue;
    sequence.truth.stamped_poses = poses;
    sequence.truth.T_posed_cam = readEurocPlacement(left_sensor) * T_left_rectified;
    return;
  }
}

}  // namespace

std::optional<Sequence> openEuroc(const SequenceSource& source) {
  for (const fs::path& mav : {source.path / "mav0", source.path}) {
    const fs::path left = mav / "cam0", right = mav / "cam1";
    if (!fs::is_directory(left / "data") || !fs::is_directory(right / "data")) continue;
    Sequence sequence{.folder = source.path, .layout = "euroc"};
    setKeyedFrames(sequence, {NameKind::kTimes, imagesOf(left), imagesOf(right)});
    setCamera(sequence, source.given, [&](ImageSize size) {
      const char* const why = "EuRoC's layout has one for each camera; or give --calibration";
      const Rig rig = readEurocRig(neededFile(left / "sensor.yaml", why), neededFile(right / "sensor.yaml", why));
      return rectifiedCamera(sequence, rig, size);
    });
    addTruth(sequence, mav, left / "sensor.yaml");
    return sequence;
  }
  return std::nullopt;
}

}  // namespace motorcade
