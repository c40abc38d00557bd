#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "apps/recorded/recorded_drive.hpp"
#include "core/frame_timing.hpp"
#include "core/messages.hpp"
#include "io/results/frame_table.hpp"

namespace motorcade {

/// Content of one frame in files for other programs, during a run or after it.
struct ExportedFrame {
  using StageTimes = std::array<FrameRow::StageTime, kStageCount>;
  struct Point {
    TrackId track;  // not valid for a point at rest
    Eigen::Vector3d p_cam;
  };
  FrameEstimate estimate;
  std::vector<Point> points;
  std::string jpeg;  // the left image; empty where it is left out
  double latency_ms = 0, decode_ms = 0;
  std::optional<StageTimes> stages;
  int points_at_rest = 0, points_undecided = 0;
};

/// The points that the front-end took, in this very frame, for points at rest or of an object.
std::vector<ExportedFrame::Point> exportedPoints(const FrameMeasurements& measurements, const StereoCamera& camera);

/// Times of the stages for a frame, as in `frames.csv`.
ExportedFrame::StageTimes stageTimes(const FrameTiming& timing);

/// One frame of a run folder, by its index in the run, without its image.
ExportedFrame exportedFrame(const RecordedDrive& drive, const RunFolder& run, std::size_t index);

/// The left image as a JPEG file. One choice for all inputs: what the pipeline saw, in a third of a PNG's bytes.
std::string exportedImage(const Image& left);

}  // namespace motorcade
