#include "apps/export/tum_export.hpp"

#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/recorded/recorded_drive.hpp"
#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"
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

}  // namespace

std::size_t exportTum(const RunFolder& run, const fs::path& folder, bool with_predicted) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw OutputError(folder.string() + ": cannot be made a folder: " + error.message());
  const RunFolder::Trajectories& shown = fullerTrajectories(run);
  writeLines(folder / "camera.tum", cameraLines(run, shown.camera, with_predicted));
  const auto objects = objectLines(run, shown.objects, with_predicted);
  for (const auto& [track, lines] : objects) writeLines(folder / fmt::format("object_{:03}.tum", track.value), lines);
  return objects.size();
}

}  // namespace motorcade
