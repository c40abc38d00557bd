#include "apps/run/input_watch.hpp"

#include <spdlog/spdlog.h>

namespace motorcade {

bool InputWatch::admits(const StereoFrame& pair) {
  if (!refused_) tell(watch_.observe(pair));
  return !refused_;
}

/// Where no point is seen in the whole drive, the run knows itself how many frames it could follow.
void InputWatch::tell(const std::vector<RigFinding>& found) {
  for (const RigFinding& each : found) {
    found_.push_back(each);
    if (each.finding.worthless && each.finding.name != "points" && !force_) {
      refused_ = true;
      spdlog::error("{}; {}--force goes on", each.text(),
                    each.last_good ? "what is written of frames before is good, " : "");
    } else {
      spdlog::warn(each.text());
    }
  }
}

}  // namespace motorcade
