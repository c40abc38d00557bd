#include "apps/report/reported_run.hpp"

#include <utility>

#include "apps/recorded/recorded_run.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

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

}  // namespace

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

}  // namespace motorcade
