#pragma once

#include <map>
#include <vector>

#include "core/ids.hpp"
#include "core/timestamp.hpp"

namespace motorcade {

/// Finds the frames of a smoothing window that have just settled: they are so much older than the newest one that
/// hardly anything of them will change. Each settles once, oldest first, and stays in the window.
class Settling {
 public:
  explicit Settling(double after_s) : after_s_(after_s) {}

  /// `frames` are those of the window, with their stamps.
  template <class Frame>
  std::vector<FrameId> operator()(const std::map<FrameId, Frame>& frames) {
    std::vector<FrameId> settled;
    for (auto it = last_.valid() ? frames.upper_bound(last_) : frames.begin(); it != frames.end(); ++it) {
      if (secondsBetween(it->second.head.stamp, frames.rbegin()->second.head.stamp) < after_s_) break;
      settled.push_back(last_ = it->first);
    }
    return settled;
  }

 private:
  double after_s_;
  FrameId last_;
};

}  // namespace motorcade
