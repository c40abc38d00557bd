#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/pipeline_params.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

struct PipelineConfig;

/// The value of --vehicle-motion that ignores a file beside the drive.
inline constexpr const char* kNoVehicleMotion = "none";

/// The command line of `motorcade run`, as the user typed it.
struct RunOptions {
  std::filesystem::path sequence, out;            // the first may be `kStandardInput`
  bool side_by_side = false, over_under = false;  // the images in a picture of a stream
  std::string topics;                             // LEFT,RIGHT of a bag's images
  std::string rate;                               // `max`, HZ, or empty for the default
  std::optional<double> fps_hz;                   // where the user gives it
  bool live = false;
  bool masks = false;
  std::filesystem::path mcap;  // file, for other programs
  std::optional<int> threads;
  std::string frames;  // A:B
  std::filesystem::path config;
  GivenCameras given;                    // --camera and --calibration
  std::filesystem::path camera_poses;    // KITTI pose lines
  std::filesystem::path vehicle_motion;  // --vehicle-motion: a file, `none`, or empty for the drive's own
  std::filesystem::path instances;       // --instances: a folder of labels, or empty
  std::vector<std::string> ignored;      // --ignore: SIDE=PIXELS or a mask's file
  std::vector<std::string> assignments;  // key=value
  std::string min_existence;             // of rows, a probability; empty for the configuration's
  std::string require;                   // tracked=FRACTION
  std::string inject;                    // faults, see FaultSpec
  bool shown = false;                    // on a page
  std::string view;                      // ADDR:PORT of that page, empty for the default
  bool force = false;                    // replace a finished run, go on where results will be worthless

  /// Capture rate of a recorded drive without times.
  double fps() const { return fps_hz.value_or(10); }
};

/// The configuration in force: defaults, then the file, then `--set`, then the options. Throws UsageError.
PipelineConfig configurationOf(const RunOptions& options);

/// Pairs per second of the replay; empty for as fast as possible. Throws UsageError.
std::optional<double> replayRate_hz(const RunOptions& options, InputPolicy policy);

/// The least share of tracked frames that the user accepts; empty when nothing is required. Throws UsageError.
std::optional<double> requiredTracking(const RunOptions& options);

/// Runs a sequence through the pipeline and writes the run folder; gives the exit code. Failures are UserErrors.
int runSequence(const RunOptions& options);

}  // namespace motorcade
