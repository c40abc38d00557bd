#include "apps/synth/output/sequence_writer.hpp"

#include <cmath>

#include <fmt/format.h>

#include "apps/synth/output/ground_truth.hpp"
#include "apps/synth/shapes/noise.hpp"
#include "io/files/file_descriptor.hpp"
#include "io/files/line_file.hpp"
#include "io/images/image_file.hpp"
#include "io/inputs/vehicle_motion.hpp"
#include "io/truth/trajectory.hpp"

namespace motorcade::synth {
namespace {

namespace fs = std::filesystem;

CalibrationErrors drawnErrors(const Scene& scene, const RigError& rig) {
  constexpr int kCalibration = 4211;
  CalibrationErrors errors;
  for (int i = 0; i < kCalibrationErrors; ++i)
    errors[i] = rig.calibration * gaussian(hashOf(i, kCalibration, scene.seed));
  return errors;
}

/// The true right camera of a frame. Its position and its principal point differ from the calibration's.
StereoCamera rightCamera(const Scene& scene, int frame, const WriteOptions& options) {
  constexpr int kShake = 4219, kBaseline = 6;  // in the order of the errors
  StereoCamera camera = options.camera;
  camera.cx_px += options.rig_error.disparity_offset_px;
  camera.cy_px += options.rig_error.row_offset_px;
  if (options.rig_error.shake_px > 0)
    camera.cx_px += options.rig_error.shake_px * gaussian(hashOf(frame, kShake, scene.seed));
  camera.baseline_m *= 1 + CalibrationSigmas{}.baseline * options.render.errors[kBaseline];
  return camera;
}

/// The gray pair as P0 and P1; P2 and P3 repeat it for readers that ask for the color pair.
void writeCalibration(const fs::path& file, const StereoCamera& c, const RigError& rig) {
  std::string text;
  for (int i = 0; i < 4; ++i)
    text += fmt::format("P{}: {:.9g} 0 {:.9g} {:.9g} 0 {:.9g} {:.9g} 0 0 0 1 0\n", i, c.fx_px, c.cx_px,
                        i % 2 == 0 ? 0.0 : -c.fx_px * c.baseline_m, c.fy_px, c.cy_px);
  if (rig == RigError{}) text += "calibration_sigmas: 0 0 0 0 0\n";
  text += "R0_rect: 1 0 0 0 1 0 0 0 1\n";
  text += "Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";
  text += "Tr_imu_to_velo: 1 0 0 0 0 1 0 0 0 0 1 0\n";
  writeAtOnce(file, text);
}

Gray16Image disparityOf(const Rendering& left, const StereoCamera& camera) {
  Gray16Image image{camera.width_px, camera.height_px, std::vector<std::uint16_t>(left.depth_m.size())};
  for (std::size_t i = 0; i < left.depth_m.size(); ++i) {
    if (left.depth_m[i] <= 0) continue;
    const double disparity_px = camera.fx_px * camera.baseline_m / static_cast<double>(left.depth_m[i]);
    image.pixels[i] = static_cast<std::uint16_t>(std::clamp(std::lround(256 * disparity_px), 1L, 65535L));
  }
  return image;
}

Image instanceMask(const Rendering& left, const StereoCamera& camera) {
  Image mask = ImagePool().acquire(camera.width_px, camera.height_px);
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x)
      mask.mutableRow(y)[x] = static_cast<std::uint8_t>(left.object[y * camera.width_px + x] + 1);
  return mask;
}

/// The text files, a line or more per frame.
struct Tables {
  explicit Tables(const fs::path& folder)
      : times(folder / "times.txt"),
        poses(folder / "poses.txt"),
        labels(folder / "label_02.txt"),
        objects(folder / "object_poses.txt") {}
  LineFile times, poses, labels, objects;

  void add(const FrameScene& frame, const SE3& T_world_map, const std::vector<Label>& seen) {
    times.writeLine(fmt::format("{:.6f}", frame.scene().frame_s * frame.frame()));
    poses.writeLine(kittiLine(T_world_map * frame.T_map_cam()));
    for (const auto& label : seen) labels.writeLine(labelLine(frame.frame(), label));
    for (const auto& object : frame.objects()) {
      const Placed& body = object.front();
      objects.writeLine(fmt::format("{} {} {} ", frame.frame(), body.id, body.moving ? 1 : 0) +
                        kittiLine(T_world_map * body.T_map_body));
    }
  }
  void close() {
    for (LineFile* file : {&times, &poses, &labels, &objects}) file->close();
  }
};

}  // namespace

void writeSequence(const Scene& scene, const fs::path& folder, const WriteOptions& asked) {
  WriteOptions options = asked;
  options.render.errors = drawnErrors(scene, options.rig_error);
  for (const char* name : {"image_0", "image_1", "disp", "instance"}) makeFolder(folder / name);
  writeCalibration(folder / "calib.txt", options.camera, options.rig_error);
  Tables tables(folder);
  const SE3 T_world_map = scene.ego.T_map_cam(scene.time_s(0)).inverse();
  const int frames = options.frames > 0 ? options.frames : scene.frames;
  for (int k = 0; k < frames; ++k) {
    const FrameScene frame(scene, k, options.with_movers);
    const Rendering left = render(frame, options.camera, StereoSide::kLeft, options.render);
    const Rendering right = render(frame, rightCamera(scene, k, options), StereoSide::kRight, options.render);
    const std::string name = fmt::format("{:06}.png", k);
    writePng(folder / "image_0" / name, left.image);
    writePng(folder / "image_1" / name, right.image);
    writePng16(folder / "disp" / name, disparityOf(left, options.camera));
    writePng(folder / "instance" / name, instanceMask(left, options.camera), PngEffort::kSmall);
    tables.add(frame, T_world_map, labelsOf(frame, options.camera, left));
    if (options.progress) options.progress(k + 1, frames);
  }
  tables.close();
  if (options.vehicle_motion) writeVehicleMotion(sensedMotion(scene, frames), folder / kVehicleMotionFile);
}

}  // namespace motorcade::synth
