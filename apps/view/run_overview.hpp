#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/recorded/recorded_drive.hpp"
#include "apps/view/run_truth.hpp"

namespace motorcade {

/// Overview of a run that is over: the data of the page's timeline, map and lists, in a few numbers per frame.
struct RunOverview {
  const RecordedDrive& drive;
  const std::map<std::int64_t, FrameRow>& rows;        // by frame of the sequence
  const std::map<std::int64_t, ShownTiming>& timings;  // the same
  const std::optional<RunTruth>& truth;
  bool paced = false;  // as in ShownRun
};

std::string toJson(const RunOverview& overview);

}  // namespace motorcade
