#include "apps/draw/draw_command.hpp"

#include <cstdio>
#include <iostream>
#include <string>

#include "apps/console/log.hpp"
#include "apps/draw/frame_view.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "io/errors.hpp"
#include "io/image_file.hpp"
#include "io/mask_image.hpp"

namespace motorcade {
namespace {

/// The truth, where there is any, moved into the world of the run's first frame.
void addTruth(DrawnRun& drawn, const Sequence& sequence) {
  const auto camera = readCameraTruth(sequence);
  if (!camera || drawn.first_frame >= std::ssize(camera->T_world_cam)) return;
  const SE3 T_run_world = camera->T_world_cam[drawn.first_frame].inverse();
  for (std::size_t i = 0; i < drawn.T_world_cam.size(); ++i) {
    const std::size_t frame = drawn.first_frame + i;
    if (frame < camera->T_world_cam.size()) drawn.T_world_cam_true.push_back(T_run_world * camera->T_world_cam[frame]);
  }
  const auto truths = readObjectTruths(sequence, *camera);
  if (!truths) return;
  for (ObjectTruth truth : truths->objects) {
    truth.T_world_object = T_run_world * truth.T_world_object;
    drawn.true_objects[truth.frame.value - drawn.first_frame].push_back(std::move(truth));
  }
}

void addCovariances(DrawnRun& drawn, const RunFolder& run) {
  for (const auto& row : run.covariances) {
    const auto objects = drawn.objects.find(row.frame.value - run.first_frame);
    if (!row.track.valid() || objects == drawn.objects.end()) continue;
    for (ObjectEstimate& object : objects->second)
      if (object.track == row.track) object.covariance = row.covariance;
  }
}

/// With the mask where the run wrote masks.
DrawnImages imagesOf(const std::filesystem::path& left, const std::filesystem::path& mask, ImagePool& pool) {
  DrawnImages images{.left = readImage(left, pool)};
  if (!std::filesystem::exists(mask)) return images;
  images.mask = readPng16(mask);
  const ImageSize size{images.mask->width, images.mask->height}, wanted{images.left.width(), images.left.height()};
  if (size != wanted)
    throw InputError(mask.string() + ": has " + size.text() + " pixels, the image has " + wanted.text());
  return images;
}

DrawnRun drawnRun(const RunFolder& run, const Sequence& sequence) {
  DrawnRun drawn;
  drawn.camera = sequence.camera;
  drawn.first_frame = run.first_frame;
  // A run that was killed has few final poses: what was published online tells more then.
  const RunFolder::Trajectories& shown = run.final.camera.size() >= run.online.camera.size() ? run.final : run.online;
  drawn.T_world_cam = shown.camera;
  for (std::size_t i = 0; i < drawn.T_world_cam.size(); ++i) {
    drawn.stamps.push_back(sequence.stamps[run.first_frame + i]);
  }
  for (const auto& row : shown.objects) drawn.objects[row.frame.value - run.first_frame].push_back(row.object);
  addCovariances(drawn, run);
  const auto points = run.folder / kObjectPointsFile;
  if (std::filesystem::exists(points))
    for (const ObjectPoint& point : readObjectPoints(points))
      drawn.points[point.frame.value - run.first_frame].push_back(point);
  addTruth(drawn, sequence);
  return drawn;
}

std::string pictureName(std::int64_t frame) {
  char name[40];
  std::snprintf(name, sizeof(name), "frame_%06lld.png", static_cast<long long>(frame));
  return name;
}

}  // namespace

int runDraw(const DrawOptions& options) {
  const RunFolder run = readRunFolder(options.run);
  const Sequence sequence = openSequenceOf(run, {options.sequence, options.fps_hz});
  const DrawnRun drawn = drawnRun(run, sequence);
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) throw OutputError(options.out.string() + ": cannot be made a folder: " + error.message());
  ImagePool pool;
  int pictures = 0;
  for (std::size_t i = 0; i < drawn.T_world_cam.size(); ++i) {
    const std::size_t frame = drawn.first_frame + i;
    if (frame < options.frames.begin || frame >= options.frames.end ||
        (frame - options.frames.begin) % options.every != 0)
      continue;
    try {
      const auto mask = maskFile(options.run / kMasksFolder, {static_cast<std::int64_t>(frame)});
      const DrawnImages images = imagesOf(sequence.frames[frame].left, mask, pool);
      writePngRgb(options.out / pictureName(frame), drawFrame(images, drawn, i).image());
      ++pictures;
    } catch (const InputError& problem) {
      std::cerr << "left out: " << problem.what() << '\n';
    }
  }
  if (tellsProgress()) std::cout << pictures << " pictures in " << options.out.string() << '\n';
  return 0;
}

}  // namespace motorcade
