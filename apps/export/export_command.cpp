#include "apps/export/export_command.hpp"

#include <iostream>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "apps/console/log.hpp"
#include "apps/console/progress.hpp"
#include "apps/export/drive_mcap.hpp"
#include "apps/export/osi_trace.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "io/files/errors.hpp"
#include "io/files/file_descriptor.hpp"
#include "io/files/line_file.hpp"
#include "io/inputs/mounting_text.hpp"
#include "io/inputs/pair_reader.hpp"
#include "io/truth/trajectory.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

void writeLines(const fs::path& file, const std::vector<std::string>& lines) {
  LineFile out(file);
  for (const std::string& line : lines) out.writeLine(line);
  out.close();
}

/// Lines of the good frames, and on request of the predicted ones. Rejected frames are left out: their time may repeat
/// another's, which tools do not accept.
std::vector<std::string> cameraLines(const RunFolder& run, const std::vector<SE3>& T_world_cam, bool with_predicted) {
  std::vector<std::string> lines;
  for (const FrameRow& row : run.frames) {
    const auto index = static_cast<std::size_t>(row.head.frame.value - run.first_frame);
    const bool wanted =
        row.head.status == FrameStatus::kGood || (with_predicted && row.head.status != FrameStatus::kRejected);
    if (wanted && index < T_world_cam.size()) lines.push_back(tumLine(row.head.stamp, T_world_cam[index]));
  }
  return lines;
}

std::map<TrackId, std::vector<std::string>> objectLines(const RunFolder& run,
                                                        const std::vector<RunFolder::ObjectRow>& rows,
                                                        bool with_predicted) {
  std::map<FrameId, Timestamp> stamps;
  for (const FrameRow& row : run.frames)
    if (row.head.status != FrameStatus::kRejected) stamps[row.head.frame] = row.head.stamp;
  std::map<TrackId, std::vector<std::string>> lines;
  for (const auto& [frame, object] : rows) {
    const auto stamp = stamps.find(frame);
    if (stamp == stamps.end() || (object.state == ObjectState::kPredicted && !with_predicted)) continue;
    lines[object.track].push_back(tumLine(stamp->second, object.T_world_body));
  }
  return lines;
}

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

std::size_t exportTum(const RunFolder& run, const fs::path& folder, bool with_predicted) {
  makeFolder(folder);
  const RunFolder::Trajectories& shown = fullerTrajectories(run);
  writeLines(folder / "camera.tum", cameraLines(run, shown.camera, with_predicted));
  const auto objects = objectLines(run, shown.objects, with_predicted);
  for (const auto& [track, lines] : objects) writeLines(folder / fmt::format("object_{:03}.tum", track.value), lines);
  return objects.size();
}

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
