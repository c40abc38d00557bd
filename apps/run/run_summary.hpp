#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/pipeline.hpp"
#include "apps/run/process_usage.hpp"
#include "apps/run/write_queue.hpp"
#include "apps/watch/rig_watch.hpp"
#include "io/inputs/pair_source.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Outcome of `run --mcap`.
struct McapSummary {
  std::string file;
  std::uint64_t bytes = 0;
  std::int64_t images_left_out = 0, frames_left_out = 0;
};

/// Images of the whole sequence.
struct ImageCounts {
  std::int64_t pairs = 0, left_missing = 0, right_missing = 0;
  std::int64_t left_out = 0;  // that belong to no frame
};

/// The content of `summary.json`.
struct RunSummary {
  PipelineSummary pipeline;
  PipelineParams params;
  QueueMark decoded;         // pairs waiting for the feeder
  WriteQueue::Load writing;  // of results, to their files
  std::string sequence, layout;
  ImageCounts images;
  GivenCameras given;                // what the user said of them
  std::string calibrated_by;         // the calibration in force, whoever named it
  std::string bayer;                 // the mosaic in force, empty for none
  int sample_bits = 8;               // that the images' samples use
  std::vector<std::string> ignored;  // pixels, as the user gave them
  std::string instances;             // the folder of labels, as the user gave it
  std::string inject;                // faults on the way from the camera, as the user gave them
  std::optional<double> rate_hz;     // of the replay; empty for as fast as it went
  double capture_rate_hz = 0;
  std::int64_t good_frames = 0;
  double wall_s = 0;
  ProcessUsage used;
  std::optional<OwnVehicleView> own_vehicle{};  // as found at the end
  struct VehicleMotionUse {
    VehicleSensors found;       // at the end
    std::int64_t samples = 0;   // that there were
    std::int64_t left_out = 0;  // frames in which they were not believed
  };
  std::optional<VehicleMotionUse> vehicle_motion{};
  std::optional<McapSummary> mcap{};
  std::vector<RigFinding> found{};  // wrong with the pairs
  bool refused = false;             // and so the run was ended
  int signal = 0;                   // that ended the run early
  SourceEnd source_end{};           // also among what was found

  void setSequence(const Sequence& of);
  /// Share of the received frames that have a measured ego-motion.
  double trackedFraction() const;
  double throughput_hz() const;
};

std::string toJson(const RunSummary& summary);
/// A few lines for the user.
std::string shortReport(const RunSummary& summary, const std::string& folder);

}  // namespace motorcade
