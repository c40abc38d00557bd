#include "io/files/errors.hpp"
#include "io/layouts/layout_cameras.hpp"
#include "io/layouts/layout_parts.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// The camera from KITTI's calib.txt, or from the calibration of a pair that is not rectified.
StereoCamera cameraOf(Sequence& sequence, bool any_pair, ImageSize size) {
  const fs::path& folder = sequence.folder;
  if (const auto camera = cameraIn(sequence, folder, {.any_pair = any_pair}, size)) return *camera;
  throw InputError(
      (folder / "calib.txt").string() +
      ": is missing. For images that are rectified, write two lines into it,\n"
      "  P0: fx 0 cx 0  0 fy cy 0  0 0 1 0\n"
      "  P1: fx 0 cx -fx*baseline  0 fy cy 0  0 0 1 0\n"
      "or give --camera fx,fy,cx,cy,baseline. For others, give --calibration with Kalibr's camchain.yaml, ROS' "
      "left.yaml,right.yaml or OpenCV's intrinsics.yml,extrinsics.yml, or lay them beside the images" +
      calibrationsMeant(folder));
}

}  // namespace

std::optional<Sequence> openPlain(const SequenceSource& source) {
  const fs::path& folder = source.path;
  for (const auto& names : kPairs) {
    const fs::path left = folder / names.left, right = folder / names.right;
    if (!fs::is_directory(left) || !fs::is_directory(right)) continue;
    Sequence sequence{.folder = folder, .layout = "plain", .pair = names.pair};
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
    setFrames(sequence, left, right);
    const bool any_pair = std::string_view(names.left) == "left";  // such folders may give either pair of keys
    setCamera(sequence, source.given, [&](ImageSize size) { return cameraOf(sequence, any_pair, size); });
    setStamps(sequence, ifExists(folder / "times.txt"), source.fps_hz);
    return sequence;
  }
  return std::nullopt;
}

}  // namespace motorcade
