#include "apps/run/given_knowledge.hpp"

#include <charconv>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include "apps/pipeline/configuration.hpp"
#include "apps/run/run_command.hpp"
#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/truth/trajectory.hpp"

namespace motorcade {
namespace {

/// The rows or columns at a side; empty where the item is none of `top=`, `bottom=`, `left=` and `right=`.
struct Band {
  std::string_view side, pixels;
};

std::optional<Band> bandOf(std::string_view item) {
  const auto equals = item.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  const std::string_view side = item.substr(0, equals);
  if (side != "top" && side != "bottom" && side != "left" && side != "right") return std::nullopt;
  return Band{side, item.substr(equals + 1)};
}

/// Reads a number of pixels: at least one, and less than all.
int pixelsOf(const Band& band, int all, const std::string& item) {
  int pixels = 0;
  const auto [end, error] = std::from_chars(band.pixels.begin(), band.pixels.end(), pixels);
  if (error != std::errc() || end != band.pixels.end() || pixels < 1 || pixels >= all)
    throw UsageError("--ignore " + item + ": write a number from 1 to " + std::to_string(all - 1) + " after " +
                     std::string(band.side) + "=");
  return pixels;
}

void addBand(PixelMask& mask, const Band& band, const std::string& item) {
  const int width = mask.width(), height = mask.height();
  if (band.side == "top") mask.add(0, 0, width, pixelsOf(band, height, item));
  if (band.side == "bottom") mask.add(0, height - pixelsOf(band, height, item), width, height);
  if (band.side == "left") mask.add(0, 0, pixelsOf(band, width, item), height);
  if (band.side == "right") mask.add(width - pixelsOf(band, width, item), 0, width, height);
}

void addImage(PixelMask& mask, const std::string& file) {
  if (!std::filesystem::exists(file))
    throw UsageError("--ignore " + file +
                     ": is neither a file nor a side; write top=, bottom=, left= or right=PIXELS, "
                     "or the path of an image that is not black where the left image is to be ignored");
  ImagePool pool;
  const Image image = readImage(file, pool, ImageSize{mask.width(), mask.height()});
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (image.at(x, y) != 0) mask.add(x, y, x + 1, y + 1);
}

}  // namespace

PixelMask ignoredPixels(const std::vector<std::string>& items, const StereoCamera& camera) {
  if (items.empty()) return {};
  PixelMask mask(camera.width_px, camera.height_px);
  for (const std::string& item : items) {
    if (const auto band = bandOf(item))
      addBand(mask, *band, item);
    else
      addImage(mask, item);
  }
  return mask;
}

std::optional<std::vector<SE3>> otherCamera(const RunOptions& options, const PipelineConfig& config,
                                            const Sequence& sequence) {
  if (options.camera_poses.empty()) return std::nullopt;
  if (config.backend.kind == BackendKind::kJoint)
    throw UsageError(
        "--camera-poses: the joint back-end estimates the camera from points and takes no other path; use backend.kind "
        "\"filter\", \"filter_map\" or \"pose_graph\"");
  std::vector<SE3> poses = readKittiPoses(options.camera_poses);
  if (poses.size() != sequence.frames.size())
    throw InputError(options.camera_poses.string() + ": " + std::to_string(poses.size()) +
                     " poses, but the sequence has " + std::to_string(sequence.frames.size()) +
                     " frames; write one line for each of them");
  return poses;
}

void replaceOdometry(Stages& stages, std::vector<SE3> T_world_cam) {
  const auto previous = std::make_shared<std::optional<FrameId>>();
  stages.incremental_optimization = [optimize = std::move(stages.incremental_optimization),
                                     T_world_cam = std::move(T_world_cam),
                                     previous](const FrameMeasurementsPtr& measurements) {
    FrameMeasurements replaced = *measurements;
    const auto poseOf = [&](FrameId frame) { return T_world_cam.at(static_cast<std::size_t>(frame.value)); };
    if (*previous) replaced.odometry.T_previous_now = poseOf(**previous).inverse() * poseOf(replaced.head.frame);
    *previous = replaced.head.frame;
    return optimize(std::make_shared<const FrameMeasurements>(std::move(replaced)));
  };
}

}  // namespace motorcade
