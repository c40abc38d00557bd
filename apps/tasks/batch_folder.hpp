#pragma once

#include <filesystem>
#include <string>

namespace motorcade {

/// The folder as other processes see it, without a slash at its end.
inline std::filesystem::path absoluteFolder(const std::filesystem::path& folder) {
  const std::filesystem::path absolute = std::filesystem::absolute(folder).lexically_normal();
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

/// Layout of the folder of a batch (docs/formats.md). No two processes write the same name in it: a result that takes
/// long is made in a folder of its own and renamed when it is complete.
class BatchFolder {
 public:
  explicit BatchFolder(const std::filesystem::path& folder) : folder_(absoluteFolder(folder)) {}

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path plan() const { return folder_ / "plan.json"; }
  std::filesystem::path sequences() const { return folder_ / "sequences"; }
  std::filesystem::path attempts() const { return folder_ / "attempts"; }
  std::filesystem::path cluster() const { return folder_ / "cluster"; }
  std::filesystem::path merged() const { return folder_ / "merged"; }
  /// Folder of a task that was performed to its end.
  std::filesystem::path result(const std::string& task) const { return folder_ / "results" / task; }
  /// Files of the last attempt that failed.
  std::filesystem::path failure(const std::string& task) const { return folder_ / "failed" / task; }

 private:
  std::filesystem::path folder_;
};

/// Files in the folder of an attempt, which becomes that of a result or of a failure.
inline std::filesystem::path recordIn(const std::filesystem::path& attempt) { return attempt / "task.json"; }
inline std::filesystem::path logIn(const std::filesystem::path& attempt) { return attempt / "log.txt"; }
inline std::filesystem::path runIn(const std::filesystem::path& attempt) { return attempt / "run"; }
/// Absent where the sequence has no truth.
inline std::filesystem::path evaluationIn(const std::filesystem::path& attempt) { return attempt / "evaluation.json"; }

}  // namespace motorcade
