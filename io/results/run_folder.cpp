#include "io/results/run_folder.hpp"

#include <algorithm>
#include <array>

#include "io/files/errors.hpp"
#include "io/files/number_text.hpp"
#include "io/files/text_file.hpp"
#include "io/results/object_row.hpp"
#include "io/truth/trajectory.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kCovariancesHeaderStart = "frame,track_id";
constexpr std::array kFinalFiles = {"camera_final.txt", "camera_final.tum", "objects_final.csv",
                                    "covariances_final.csv", "pose_covariances_final.csv"};
constexpr const char* kUnfinished = ".part";  // added to the names of the final files until the run has ended

fs::path preparedFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    throw OutputError(folder.string() +
                      ": cannot be made a folder: " + (error ? error.message() : "a file of this name is there"));
  }
  return folder;
}

/// Locks the folder for this run alone and removes the summary of an earlier one.
FolderLock locked(const fs::path& folder) {
  FolderLock lock(folder);
  std::error_code error;
  fs::remove(folder / "summary.json", error);
  if (error)
    throw OutputError((folder / "summary.json").string() +
                      ": an earlier summary cannot be removed: " + error.message());
  return lock;
}

std::string covarianceLine(FrameId frame, TrackId track, const Matrix6d& covariance) {
  std::string line;
  line.reserve(400);
  appendInteger(line, frame.value);
  line += ',';
  appendInteger(line, track.valid() ? track.value : -1);
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      line += ',';
      appendScientific(line, covariance(row, column), 6);
    }
  }
  return line;
}

std::string covariancesHeader() {
  std::string header(kCovariancesHeaderStart);
  const auto unit = [](int row, int column) { return column < 3 ? "_m2" : row < 3 ? "_m_rad" : "_rad2"; };
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column)
      header.append(",c").append(std::to_string(row)).append(std::to_string(column)).append(unit(row, column));
  return header;
}

std::string covariancesName(const std::string& kind) {
  return kind == "online" ? "covariances.csv" : "covariances_" + kind + ".csv";
}

// ---- reading ----

std::vector<RunFolder::ObjectRow> readObjects(const fs::path& file) {
  std::vector<RunFolder::ObjectRow> rows;
  if (!fs::exists(file)) return rows;
  for (const auto& line : readTable(file, kObjectsHeaderStart)) {
    FieldReader fields(file, line, ',');
    RunFolder::ObjectRow row;
    row.frame.value = fields.integer("frame");
    row.object = readObject(fields);
    fields.expectEnd();
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<RunFolder::CovarianceRow> readCovariances(const fs::path& file) {
  std::vector<RunFolder::CovarianceRow> rows;
  if (!fs::exists(file)) return rows;
  for (const auto& line : readTable(file, kCovariancesHeaderStart)) {
    FieldReader fields(file, line, ',');
    RunFolder::CovarianceRow covariance;
    covariance.frame.value = fields.integer("frame");
    covariance.track.value = fields.integer("track_id");
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column) {
        covariance.covariance(row, column) = covariance.covariance(column, row) = fields.number("covariance");
      }
    }
    fields.expectEnd();
    rows.push_back(covariance);
  }
  return rows;
}

std::vector<SE3> readCamera(const fs::path& file) {
  std::vector<SE3> poses;
  if (!fs::exists(file)) return poses;
  for (const auto& line : readLines(file, LastLine::kDropIfCut)) {
    FieldReader fields(file, line);
    poses.push_back(fields.pose("a pose"));
    fields.expectEnd();
  }
  return poses;
}

RunFolder::Trajectories readTrajectories(const fs::path& folder, const std::string& kind) {
  return {.camera = readCamera(folder / ("camera_" + kind + ".txt")),
          .objects = readObjects(folder / ("objects_" + kind + ".csv")),
          .covariances = readCovariances(folder / covariancesName(kind)),
          .pose_covariances = readCovariances(folder / ("pose_covariances_" + kind + ".csv"))};
}

}  // namespace

RunFolderWriter::Files::Files(const fs::path& folder, const std::string& kind, const std::string& suffix)
    : kitti(folder / ("camera_" + kind + ".txt" + suffix)),
      tum(folder / ("camera_" + kind + ".tum" + suffix)),
      objects(folder / ("objects_" + kind + ".csv" + suffix)),
      covariances(folder / (covariancesName(kind) + suffix)),
      pose_covariances(folder / ("pose_covariances_" + kind + ".csv" + suffix)) {
  objects.writeLine(kObjectsHeader);
  for (LineFile* file : {&covariances, &pose_covariances}) file->writeLine(covariancesHeader());
}

void RunFolderWriter::Files::close() {
  for (LineFile* file : {&kitti, &tum, &objects, &covariances, &pose_covariances}) file->close();
}

void RunFolderWriter::Files::writeCovariances(const FrameEstimate& estimate) {
  const FrameId frame = estimate.head.frame;
  const CameraCovariances& camera = estimate.camera_covariances;
  if (camera.pose) pose_covariances.writeLine(covarianceLine(frame, {}, *camera.pose));
  if (camera.motion) covariances.writeLine(covarianceLine(frame, {}, *camera.motion));
  for (const auto& object : estimate.objects)
    if (object.covariance) covariances.writeLine(covarianceLine(frame, object.track, *object.covariance));
}

void RunFolderWriter::Files::write(const FrameEstimate& estimate) {
  writeCovariances(estimate);
  for (const auto& object : estimate.objects) objects.writeLine(objectLine(estimate.head.frame, object));
  if (estimate.head.status != FrameStatus::kRejected) tum.writeLine(tumLine(estimate.head.stamp, estimate.T_world_cam));
  kitti.writeLine(kittiLine(estimate.T_world_cam));  // last: a frame with a pose has all its objects
}

RunFolderWriter::RunFolderWriter(const fs::path& folder)
    : folder_(preparedFolder(folder)),
      lock_(locked(folder_)),
      online_(folder_, "online"),
      settled_(folder_, "final"),
      final_(folder_, "final", kUnfinished),
      frames_(folder_ / "frames.csv"),
      trace_(folder_ / "trace.json") {
  frames_.writeLine(framesHeader());
}

RunFolderWriter::~RunFolderWriter() {
  if (finished_) return;
  std::error_code ignored;
  for (const char* file : kFinalFiles) fs::remove(folder_ / (file + std::string(kUnfinished)), ignored);
}

void RunFolderWriter::writeConfig(std::string_view toml) { writeAtOnce(folder_ / "effective_config.toml", toml); }

void RunFolderWriter::writeOnline(const FrameEstimate& estimate) { online_.write(estimate); }

void RunFolderWriter::writeSettled(const FrameEstimate& estimate) { settled_.write(estimate); }

void RunFolderWriter::writeFinal(const FrameEstimate& estimate) { final_.write(estimate); }

void RunFolderWriter::writeTiming(const FrameTiming& timing) {
  lock_.check();
  frames_.writeLine(frameLine(timing));
  trace_.write(timing);
}

void RunFolderWriter::finish(std::string_view summary_json) {
  trace_.close();
  frames_.close();
  for (Files* files : {&online_, &settled_, &final_}) files->close();
  for (const char* file : kFinalFiles) replace(folder_ / (file + std::string(kUnfinished)), folder_ / file);
  finished_ = true;
  writeAtOnce(folder_ / "summary.json", summary_json);
}

RunFolder readRunFolder(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw InputError(folder.string() + ": is no run folder");
  RunFolder run{.folder = folder};
  if (!fs::exists(folder / "camera_online.txt") && !fs::exists(folder / "camera_final.txt")) {
    throw InputError(folder.string() + ": is no run folder: neither camera_online.txt nor camera_final.txt is there");
  }
  run.frames = readFrames(folder / "frames.csv");
  if (!run.frames.empty()) run.first_frame = run.frames.front().head.frame.value;
  run.online = readTrajectories(folder, "online");
  run.final = readTrajectories(folder, "final");
  if (fs::exists(folder / "summary.json")) run.summary_json = readWhole(folder / "summary.json");
  return run;
}

}  // namespace motorcade
