#include "apps/report/report_command.hpp"

#include <iostream>

#include "apps/console/log.hpp"
#include "apps/html/html_page.hpp"
#include "apps/html/svg_chart.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {
namespace {

constexpr std::string_view kStyle = R"css(
.grid { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(min(100%, 26rem), 1fr)); }
.grid figure { margin: 0; }
@media (min-width: 40.1rem) { .cards { grid-template-columns: repeat(auto-fit, minmax(7.8rem, 1fr)); } }
.card .value { font-size: 1.3rem; white-space: nowrap; }
details { margin: 1rem 0; } summary { cursor: pointer; color: var(--accent); }
details pre { font-size: 0.78rem; max-height: 40rem; }
@media print { details pre { max-height: none; white-space: pre-wrap; font-size: 7pt; } }
)css";

/// Finds the sequence. Without it, as when the images have moved, a report still tells the rest.
void findSequence(ReportedRun& reported, const ReportOptions& options) {
  try {
    reported.sequence = openSequenceOf(reported.run, {options.sequence, options.fps_hz});
  } catch (const InputError& problem) {
    if (!options.sequence.empty() || !options.baseline.empty()) throw;
    reported.missing = problem.what();
  }
}

/// Evaluates the run. The truth may lack the frames that were run.
void measure(ReportedRun& reported, const ReportOptions& options) {
  EvaluateOptions evaluate;
  evaluate.run = options.run;
  evaluate.sequence = options.sequence;
  evaluate.fps_hz = options.fps_hz;
  evaluate.baseline = options.baseline;
  try {
    reported.evaluation = evaluateRun(evaluate);
  } catch (const InputError& problem) {
    if (!options.baseline.empty()) throw;
    reported.missing = problem.what();
  }
}

/// Moves poses into the run's world, which is its first camera.
std::vector<SE3> fromFirst(std::vector<SE3> poses) {
  if (poses.empty()) return poses;
  const SE3 T_run_world = poses.front().inverse();
  for (SE3& pose : poses) pose = T_run_world * pose;
  return poses;
}

/// Throws InputError if the run, or a file that the user named, cannot be read.
ReportedRun readReportedRun(const ReportOptions& options) {
  ReportedRun reported{.run = readRunFolder(options.run), .drive = {}};
  findSequence(reported, options);
  if (!reported.sequence) {
    reported.drive = recordedDrive(reported.run);
    return reported;
  }
  const Sequence& sequence = *reported.sequence;
  reported.drive = recordedDrive(reported.run, sequence);
  if (readCameraTruth(sequence)) measure(reported, options);
  if (!options.baseline.empty())
    reported.baseline = fromFirst(
        baselinePoses(options.baseline, reported.run.first_frame, reported.drive.T_world_cam.size(), sequence));
  return reported;
}

}  // namespace

int runReport(const ReportOptions& options) {
  const ReportedRun reported = readReportedRun(options);
  std::string body;
  for (const auto section :
       {runSection, driveSection, pictureSection, accuracySection, latencySection, settingsSection})
    body += section(reported);
  const auto file = options.out.empty() ? options.run / "report.html" : options.out;
  writeAtOnce(file, htmlPage("Motorcade: " + reported.drive.name, body, std::string(kChartStyle).append(kStyle)));
  if (tellsProgress()) std::cout << "report in " << file.string() << '\n';
  return 0;
}

}  // namespace motorcade
