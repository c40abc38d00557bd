#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/frame_timing.hpp"
#include "core/messages.hpp"
#include "io/files/file_descriptor.hpp"
#include "io/files/line_file.hpp"
#include "io/results/frame_table.hpp"
#include "io/results/trace_file.hpp"

namespace motorcade {

/// Writes a run folder (docs/formats.md). Frames come in order, each exactly once as online and once as final, and at
/// most once as settled. Each write adds whole lines, so that the folder is readable at any moment. Not thread safe.
/// Every failure is an OutputError naming the file.
class RunFolderWriter {
 public:
  /// Makes the folder if need be, locks it for this run, removes an earlier run's summary and makes the files anew.
  explicit RunFolderWriter(const std::filesystem::path& folder);
  ~RunFolderWriter();
  RunFolderWriter(const RunFolderWriter&) = delete;
  RunFolderWriter& operator=(const RunFolderWriter&) = delete;

  void writeConfig(std::string_view toml);
  /// Writes `camera_online.*`, `objects_online.csv`, and where the estimate has covariances, `covariances.csv` and
  /// `pose_covariances_online.csv`.
  void writeOnline(const FrameEstimate& estimate);
  /// Writes what the final files hold until `finish`, so that a run that is killed has some.
  void writeSettled(const FrameEstimate& estimate);
  /// Writes what the final files hold from `finish` on: the same files as online, but `covariances_final.csv`.
  void writeFinal(const FrameEstimate& estimate);
  /// Writes `frames.csv` and `trace.json`. Notices when the folder is no longer there.
  void writeTiming(const FrameTiming& timing);
  /// Closes all files, then writes `summary.json`: a run with this file is complete.
  void finish(std::string_view summary_json);

 private:
  struct Files {
    Files(const std::filesystem::path& folder, const std::string& kind, const std::string& suffix = "");
    LineFile kitti, tum, objects, covariances, pose_covariances;
    void write(const FrameEstimate& estimate);
    void close();

   private:
    void writeCovariances(const FrameEstimate& estimate);
  };
  std::filesystem::path folder_;
  FolderLock lock_;
  Files online_, settled_, final_;
  LineFile frames_;
  TraceFile trace_;
  bool finished_ = false;
};

/// A run folder as it is read back. A run that was killed has fewer rows and no summary.
struct RunFolder {
  struct ObjectRow {
    FrameId frame;
    ObjectEstimate object;  // without covariance
  };
  struct CovarianceRow {
    FrameId frame;
    TrackId track;  // not valid for the camera
    Matrix6d covariance;
  };
  /// Poses and objects of one kind, online or final. Line i of the camera file belongs to frame first_frame + i.
  struct Trajectories {
    std::vector<SE3> camera{};
    std::vector<ObjectRow> objects{};
    std::vector<CovarianceRow> covariances{};       // of the camera's motion and of objects seen from it
    std::vector<CovarianceRow> pose_covariances{};  // of the camera in the world
  };

  std::filesystem::path folder{};
  std::int64_t first_frame = 0;  // of the sequence; not zero when the run began later
  std::vector<FrameRow> frames{};
  Trajectories online{}, final{};
  std::string summary_json{};  // empty when the run did not complete

  bool complete() const { return !summary_json.empty(); }
};

/// Reads a run folder; throws InputError naming file and line. A last line that was cut off by a kill is ignored.
RunFolder readRunFolder(const std::filesystem::path& folder);

}  // namespace motorcade
