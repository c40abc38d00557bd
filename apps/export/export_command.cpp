#include "apps/export/export_command.hpp"

#include <iostream>
#include <string>

#include <fmt/format.h>

#include "apps/console/log.hpp"
#include "apps/console/progress.hpp"
#include "apps/export/drive_mcap.hpp"
#include "apps/export/osi_trace.hpp"
#include "apps/export/tum_export.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "io/files/errors.hpp"
#include "io/inputs/mounting_text.hpp"
#include "io/inputs/pair_reader.hpp"

namespace motorcade {
namespace {

void tell(const std::string& line) {
  if (tellsProgress()) std::cout << line << '\n';
}

/// Adds the image of a frame. If it cannot be read, the frame is written without it, which is reported.
void addImage(ExportedFrame& frame, const Sequence& sequence, PairReader& reader) {
  try {
    const FramePaths& paths = sequence.frames[frame.estimate.head.frame.value];
    frame.jpeg = exportedImage(reader.read(paths, StereoSide::kLeft));
  } catch (const InputError& problem) {
    std::cerr << "left out: " << problem.what() << '\n';
  }
}

void exportMcap(const RunFolder& run, const ExportOptions& options) {
  const Sequence sequence = openSequenceOf(run, {options.sequence, options.fps_hz});
  const RecordedDrive drive = recordedDrive(run, sequence);
  DriveMcap out(options.mcap, sequence.camera);
  PairReader reader(sequence);
  Progress progress("frame", drive.T_world_cam.size());
  for (std::size_t i = 0; i < drive.T_world_cam.size(); ++i) {
    ExportedFrame frame = exportedFrame(drive, run, i);
    addImage(frame, sequence, reader);
    out.write(frame);
    progress.show(i + 1);
  }
  out.close();
  tell(fmt::format("{} frames, {:.1f} MB in {}", drive.T_world_cam.size(), 1e-6 * static_cast<double>(out.bytes()),
                   options.mcap.string()));
}

std::optional<SE3> mountingOf(const ExportOptions& options) {
  if (options.mounting.empty()) return std::nullopt;
  if (options.osi.empty()) throw UsageError("--mounting is for --osi FILE; the other files are of the camera");
  return parseMounting(options.mounting);
}

}  // namespace

int runExport(const ExportOptions& options) {
  if (options.mcap.empty() && options.tum.empty() && options.osi.empty())
    throw UsageError("motorcade export: say what to write: --mcap FILE, --osi FILE, --tum DIR, or several of them");
  const auto T_vehicle_sensor = mountingOf(options);
  const RunFolder run = readRunFolder(options.run);
  if (!options.mcap.empty()) exportMcap(run, options);
  if (!options.osi.empty()) {
    const OsiTrace trace = exportOsi(run, options.osi, T_vehicle_sensor);
    tell(fmt::format("{} frames with {} detected objects, {:.1f} MB in {}", trace.frames, trace.objects,
                     1e-6 * static_cast<double>(trace.bytes), options.osi.string()));
  }
  if (!options.tum.empty()) {
    const std::size_t objects = exportTum(run, options.tum, options.with_predicted);
    tell(fmt::format("trajectories of the camera and {} objects in {}", objects, options.tum.string()));
  }
  return 0;
}

}  // namespace motorcade
