#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "apps/recorded/recorded_drive.hpp"
#include "apps/view/run_counts.hpp"
#include "apps/view/run_truth.hpp"
#include "apps/view/shown_frame.hpp"

/// Messages of the server to the page (docs/view.md), as JSON.
namespace motorcade {

/// The run that is being shown.
struct ShownRun {
  std::string name{}, folder{};  // of the sequence; of the results
  bool recorded = false;         // a run that is over, so that every frame is there
  bool can_pause = false;
  std::int64_t first_frame = 0, end_frame = 0;
  Timestamp first_stamp{};
  double rate_hz = 10;  // of the capture
  bool paced = false;   // latencies count from when a pair was due; else mostly waiting is in them
  StereoCamera camera{};
  std::string against{};  // the other run's folder, where two are shown
};

enum class FrameDetail { kAll, kWithoutImageParts };

/// CSS color of a track, the same as in pictures.
std::string trackColorText(TrackId track);
std::string toJson(const ShownRun& run);
std::string toJson(const ShownFrame& frame, Timestamp first_stamp, FrameDetail detail = FrameDetail::kAll);
/// `{"run":...,"frame":...}`; `frame_json` may be empty.
std::string eventJson(const RunSnapshot& run, const std::string& frame_json);

/// Overview of a run that is over: the data of the page's timeline, map and lists, in a few numbers per frame.
struct RunOverview {
  const RecordedDrive& drive;
  const std::map<std::int64_t, FrameRow>& rows;  // by frame of the sequence
  const std::optional<RunTruth>& truth;
  bool paced = false;  // as in ShownRun
};

std::string toJson(const RunOverview& overview);

}  // namespace motorcade
