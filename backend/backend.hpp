#pragma once

#include <vector>

#include "core/messages.hpp"

namespace motorcade {

/// Turns measurements into trajectories. Call in frame order: a back-end remembers all frames of its window.
class Backend {
 public:
  Backend() = default;
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;
  virtual ~Backend() = default;

  /// Returns the newest frame's estimate, and those that left the window. Throws nothing: numerical trouble shows in
  /// the result.
  virtual EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) = 0;

  /// Returns final estimates of the frames still in the window, oldest first. No further frame may follow.
  virtual std::vector<FrameEstimate> finish() = 0;
};

}  // namespace motorcade
