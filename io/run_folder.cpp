#include "io/run_folder.hpp"

#include <algorithm>
#include <array>

#include "io/errors.hpp"
#include "io/number_text.hpp"
#include "io/object_row.hpp"
#include "io/text_file.hpp"
#include "io/trajectory.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kCovariancesHeaderStart = "frame,track_id";
/// A frame's status as it is written: a good frame with a cause is degraded.
struct WrittenStatus {
  FrameStatus status = FrameStatus::kGood;
  bool degraded = false;
};
constexpr std::array kStatuses = {WrittenStatus{FrameStatus::kGood}, WrittenStatus{FrameStatus::kGood, true},
                                  WrittenStatus{FrameStatus::kLost}, WrittenStatus{FrameStatus::kRejected},
                                  WrittenStatus{FrameStatus::kDropped}};
std::string_view writtenName(WrittenStatus written) {
  return written.degraded ? "degraded" : statusName(written.status);
}
constexpr std::array kCauses = {FrameCause::kNone,         FrameCause::kAfterGap,   FrameCause::kFewPoints,
                                FrameCause::kNothingFound, FrameCause::kUnlinked,   FrameCause::kFailed,
                                FrameCause::kUnusable,     FrameCause::kOutOfOrder, FrameCause::kTooLate};
constexpr std::array<std::string_view, kCauseCount> kCauseNames = {
    "none", "after_gap", "few_points", "nothing_found", "unlinked", "failed", "unusable", "out_of_order", "too_late"};

constexpr std::array kFinalFiles = {"camera_final.txt", "camera_final.tum", "objects_final.csv"};
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

/// For this run alone; the summary of an earlier one goes.
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

std::string framesHeader() {
  std::string header("frame,status,stamp_ns,latency_ms,decode_ms");
  for (const auto& stage : kStageKeys) header.append(",").append(stage).append("_ms");
  return header.append(",cause,segment");
}

std::string frameLine(const FrameTiming& timing) {
  std::string line;
  appendInteger(line, timing.frame.value);
  line += ',';
  const bool degraded = timing.status == FrameStatus::kGood && timing.cause != FrameCause::kNone;
  line += writtenName({timing.status, degraded});
  line += ',';
  appendInteger(line, timing.stamp.ns);
  const auto add = [&](double value_ms) {
    line += ',';
    appendFixed(line, value_ms, 3);
  };
  add(timing.latency_ms());
  add(timing.decode_ms);
  for (const auto& span : timing.stages) add(span.duration_ms());
  line += ',';
  line += causeName(timing.cause);
  line += ',';
  appendInteger(line, timing.segment);
  return line;
}

std::string stageEvent(std::string_view name, FrameId frame, const StageSpan& span, SteadyTime origin) {
  std::string line;
  line.append(R"({"name":")").append(name).append(R"(","ph":"X","pid":1,"tid":)");
  appendInteger(line, span.worker);
  line.append(R"(,"ts":)");
  appendFixed(line, 1e3 * millisecondsBetween(origin, span.start), 3);
  line.append(R"(,"dur":)");
  appendFixed(line, 1e3 * span.duration_ms(), 3);
  line.append(R"(,"args":{"frame":)");
  appendInteger(line, frame.value);
  return line.append("}},");
}

std::string asyncEvent(char phase, FrameId frame, SteadyTime at, SteadyTime origin) {
  std::string line;
  line.append(R"({"name":"frame","cat":"frame","ph":")").append(1, phase).append(R"(","pid":1,"tid":0,"id":)");
  appendInteger(line, frame.value);
  line.append(R"(,"ts":)");
  appendFixed(line, 1e3 * millisecondsBetween(origin, at), 3);
  return line.append("},");
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

std::vector<RunFolder::FrameRow> readFrames(const fs::path& file) {
  std::vector<RunFolder::FrameRow> rows;
  if (!fs::exists(file)) return rows;
  for (const auto& line : readTable(file, "frame,status,stamp_ns,latency_ms")) {
    FieldReader fields(file, line, ',');
    RunFolder::FrameRow row;
    row.frame.value = fields.integer("frame");
    row.status = fields.byName("status", kStatuses, writtenName).status;
    row.stamp.ns = fields.integer("stamp_ns");
    row.latency_ms = fields.number("latency_ms");
    fields.number("decode_ms");
    for (const auto& stage : kStageKeys) fields.number(stage);
    if (!fields.atEnd()) {  // files of earlier versions end here
      row.cause = fields.byName("cause", kCauses, causeName);
      row.segment = static_cast<int>(fields.integer("segment"));
    }
    rows.push_back(row);
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

}  // namespace

std::string_view statusName(FrameStatus status) {
  switch (status) {
    case FrameStatus::kGood:
      return "good";
    case FrameStatus::kLost:
      return "lost";
    case FrameStatus::kRejected:
      return "rejected";
    case FrameStatus::kDropped:
      return "dropped";
  }
  return "good";
}

std::string_view causeName(FrameCause cause) { return kCauseNames[static_cast<std::size_t>(cause)]; }

RunFolderWriter::Files::Files(const fs::path& folder, const std::string& kind, const std::string& suffix)
    : kitti(folder / ("camera_" + kind + ".txt" + suffix)),
      tum(folder / ("camera_" + kind + ".tum" + suffix)),
      objects(folder / ("objects_" + kind + ".csv" + suffix)) {
  objects.writeLine(kObjectsHeader);
}

void RunFolderWriter::Files::close() {
  for (LineFile* file : {&kitti, &tum, &objects}) file->close();
}

void RunFolderWriter::Files::write(const FrameEstimate& estimate) {
  for (const auto& object : estimate.objects) objects.writeLine(objectLine(estimate.frame, object));
  if (estimate.status != FrameStatus::kRejected) tum.writeLine(tumLine(estimate.stamp, estimate.T_world_cam));
  kitti.writeLine(kittiLine(estimate.T_world_cam));  // last: a frame with a pose has all its objects
}

RunFolderWriter::RunFolderWriter(const fs::path& folder)
    : folder_(preparedFolder(folder)),
      lock_(locked(folder_)),
      online_(folder_, "online"),
      settled_(folder_, "final"),
      final_(folder_, "final", kUnfinished),
      covariances_(folder_ / "covariances.csv"),
      frames_(folder_ / "frames.csv"),
      trace_(folder_ / "trace.json") {
  frames_.writeLine(framesHeader());
  covariances_.writeLine(covariancesHeader());
  trace_.writeLine("[");
}

RunFolderWriter::~RunFolderWriter() {
  if (finished_) return;
  std::error_code ignored;
  for (const char* file : kFinalFiles) fs::remove(folder_ / (file + std::string(kUnfinished)), ignored);
}

void RunFolderWriter::writeConfig(std::string_view toml) { writeAtOnce(folder_ / "effective_config.toml", toml); }

void RunFolderWriter::writeOnline(const FrameEstimate& estimate) {
  if (estimate.camera_covariance)
    covariances_.writeLine(covarianceLine(estimate.frame, {}, *estimate.camera_covariance));
  for (const auto& object : estimate.objects) {
    if (object.covariance) covariances_.writeLine(covarianceLine(estimate.frame, object.track, *object.covariance));
  }
  online_.write(estimate);
}

void RunFolderWriter::writeSettled(const FrameEstimate& estimate) { settled_.write(estimate); }

void RunFolderWriter::writeFinal(const FrameEstimate& estimate) { final_.write(estimate); }

void RunFolderWriter::writeTiming(const FrameTiming& timing) {
  lock_.check();
  frames_.writeLine(frameLine(timing));
  if (!origin_) origin_ = timing.due;
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const StageSpan& span = timing.stages[i];
    if (span.start != span.end) trace_.writeLine(stageEvent(kStageKeys[i], timing.frame, span, *origin_));
  }
  // The whole way of a frame overlaps with that of the next, which only the asynchronous kind of event can show.
  trace_.writeLine(asyncEvent('b', timing.frame, timing.due, *origin_));
  trace_.writeLine(asyncEvent('e', timing.frame, timing.published, *origin_));
}

void RunFolderWriter::finish(std::string_view summary_json) {
  // A metadata event closes the array without a comma, so that strict JSON readers accept a complete trace.
  trace_.writeLine(R"({"name":"process_name","ph":"M","pid":1,"tid":0,"args":{"name":"motorcade"}})");
  trace_.writeLine("]");
  for (LineFile* file : {&covariances_, &frames_, &trace_}) file->close();
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
  if (!run.frames.empty()) run.first_frame = run.frames.front().frame.value;
  run.online = {readCamera(folder / "camera_online.txt"), readObjects(folder / "objects_online.csv")};
  run.final = {readCamera(folder / "camera_final.txt"), readObjects(folder / "objects_final.csv")};
  run.covariances = readCovariances(folder / "covariances.csv");
  if (fs::exists(folder / "summary.json")) run.summary_json = readWhole(folder / "summary.json");
  return run;
}

}  // namespace motorcade
