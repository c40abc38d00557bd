#include "apps/draw/draw_command.hpp"

#include <cstdio>
#include <iostream>
#include <string>

#include "apps/console/log.hpp"
#include "apps/draw/drawn_images.hpp"
#include "apps/draw/frame_view.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "io/errors.hpp"
#include "io/image_file.hpp"
#include "io/pair_reader.hpp"

namespace motorcade {
namespace {

std::string pictureName(std::int64_t frame) {
  char name[40];
  std::snprintf(name, sizeof(name), "frame_%06lld.png", static_cast<long long>(frame));
  return name;
}

}  // namespace

int runDraw(const DrawOptions& options) {
  const RunFolder run = readRunFolder(options.run);
  const Sequence sequence = openSequenceOf(run, {options.sequence, options.fps_hz});
  const RecordedDrive drive = recordedDrive(run, sequence);
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) throw OutputError(options.out.string() + ": cannot be made a folder: " + error.message());
  PairReader reader(sequence);
  int pictures = 0;
  for (std::size_t i = 0; i < drive.T_world_cam.size(); ++i) {
    const std::size_t frame = drive.first_frame + i;
    if (frame < options.frames.begin || frame >= options.frames.end ||
        (frame - options.frames.begin) % options.every != 0)
      continue;
    try {
      const DrawnImages images = readDrawnImages(sequence, frame, options.run, reader);
      writePngRgb(options.out / pictureName(frame), drawFrame(images, drive, i));
      ++pictures;
    } catch (const InputError& problem) {
      std::cerr << "left out: " << problem.what() << '\n';
    }
  }
  if (tellsProgress()) std::cout << pictures << " pictures in " << options.out.string() << '\n';
  return 0;
}

}  // namespace motorcade
