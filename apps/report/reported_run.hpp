#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/evaluate/measures/evaluation.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "apps/report/report_command.hpp"
#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// The data of a report.
struct ReportedRun {
  RunFolder run;
  std::optional<Sequence> sequence{};      // empty where it is no longer there
  std::string missing{};                   // why there is no sequence, or no evaluation though there is truth
  RecordedDrive drive;                     // without truth and camera where there is no sequence
  std::optional<Evaluation> evaluation{};  // where there is truth
  std::vector<SE3> baseline{};             // poses in the run's world; may be empty
};

/// Throws InputError if the run, or a file that the user named, cannot be read.
ReportedRun readReportedRun(const ReportOptions& options);

}  // namespace motorcade
