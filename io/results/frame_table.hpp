#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/frame_timing.hpp"
#include "core/messages.hpp"

/// `frames.csv` of a run folder: the outcome of each frame, and its times.
namespace motorcade {

std::string_view statusName(FrameStatus status);
std::string_view causeName(FrameCause cause);

/// A row as read back.
struct FrameRow {
  struct StageTime {
    double work_ms = 0, wait_ms = 0, cpu_ms = 0;
  };
  FrameHead head;  // good also where `degraded` stands
  double latency_ms = 0, decode_ms = 0;
  std::array<StageTime, kStageCount> stages{};
  double entry_wait_ms = 0, publish_wait_ms = 0;
  int points = 0, inliers = 0, objects = 0;
  bool has_waits = false;  // false in files of earlier versions, which end with the segment or before
};

std::string framesHeader();
std::string frameLine(const FrameTiming& timing);
/// Reads columns by their names in the header: unknown ones are passed over, missing ones leave a row's defaults.
/// Empty where there is no such file. Throws InputError naming file, line and column.
std::vector<FrameRow> readFrames(const std::filesystem::path& file);

}  // namespace motorcade
