#include "apps/run/input_watch.hpp"

#include <spdlog/spdlog.h>

namespace motorcade {

bool InputWatch::admits(const StereoFrame& pair) {
  check_.observe(pair);
  if (check_.complete()) tell();
  return !refused_;
}

void InputWatch::finish() { tell(); }

void InputWatch::tell() {
  if (told_) return;
  told_ = true;
  for (const Finding& finding : check_.findings()) {
    if (finding.worthless && !force_) {
      refused_ = true;
      spdlog::error("{}; --force goes on", finding.text);
    } else {
      spdlog::warn(finding.text);
    }
  }
}

}  // namespace motorcade
