#include "apps/run/input_watch.hpp"

#include <fmt/format.h>

#include "apps/console/log.hpp"

namespace motorcade {

bool InputWatch::admits(const StereoFrame& pair) {
  if (!refused_) tell(watch_.observe(pair));
  return !refused_;
}

/// Logs the findings. "points" (the whole drive shows none) refuses nothing: the run itself counts the frames it
/// followed.
void InputWatch::tell(const std::vector<RigFinding>& found) {
  for (const RigFinding& each : found) {
    found_.push_back(each);
    if (each.finding.worthless && each.finding.name != "points" && !force_) {
      refused_ = true;
      logError(fmt::format("{}; {}--force goes on", each.text(),
                           each.last_good ? "what is written of frames before is good, " : ""));
    } else {
      logWarning(each.text());
    }
  }
}

}  // namespace motorcade
