#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/evaluate/measures/evaluation.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"

/// The command `report`, and the sections of its page as HTML for the body; empty where there is nothing to tell.
namespace motorcade {

struct ReportOptions {
  std::filesystem::path run{}, out{};  // RUN/report.html when empty
  std::filesystem::path sequence{};    // the one that the run names when empty
  std::optional<double> fps_hz{};      // of a sequence without times; the run's when empty
  std::filesystem::path baseline{};    // camera poses to compare with; empty for none
};

/// Writes a page about a run, in one file that needs no other; returns the exit code. Failures are UserErrors.
int runReport(const ReportOptions& options);

/// The data of a report.
struct ReportedRun {
  RunFolder run;
  std::optional<Sequence> sequence{};      // empty where it is no longer there
  std::string missing{};                   // why there is no sequence, or no evaluation though there is truth
  RecordedDrive drive;                     // without truth and camera where there is no sequence
  std::optional<Evaluation> evaluation{};  // where there is truth
  std::vector<SE3> baseline{};             // poses in the run's world; may be empty
};

/// The run, its extent, and the most important figures.
std::string runSection(const ReportedRun& reported);
/// The drive from above, and each object's speed with its uncertainty.
std::string driveSection(const ReportedRun& reported);
/// The camera's error over time, and the tables of `evaluate`.
std::string accuracySection(const ReportedRun& reported);
/// A few annotated frames.
std::string pictureSection(const ReportedRun& reported);
/// The latency of results, and its parts in the pipeline.
std::string latencySection(const ReportedRun& reported);
/// Every parameter in force, and the versions of program and libraries.
std::string settingsSection(const ReportedRun& reported);

}  // namespace motorcade
