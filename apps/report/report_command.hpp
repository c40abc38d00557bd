#pragma once

#include <filesystem>
#include <optional>

namespace motorcade {

struct ReportOptions {
  std::filesystem::path run{}, out{};  // RUN/report.html when empty
  std::filesystem::path sequence{};    // the one that the run names when empty
  std::optional<double> fps_hz{};      // of a sequence without times; the run's when empty
  std::filesystem::path baseline{};    // camera poses to compare with; empty for none
};

/// Writes a page about a run, in one file that needs no other; returns the exit code. Failures are UserErrors.
int runReport(const ReportOptions& options);

}  // namespace motorcade
