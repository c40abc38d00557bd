#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/pipeline/pipeline_result.hpp"
#include "apps/run/run_watch.hpp"
#include "apps/run/write_queue.hpp"
#include "apps/watch/vehicle_news.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Takes the pipeline's results, in order, to the listeners and on to their files, and logs oddities. Throws the
/// OutputError that writing met.
class Recorder {
 public:
  Recorder(const ResultFiles& files, const WriteQueue::Bounds& bounds, RunListeners listeners, std::size_t frames);

  void record(PipelineResult result);
  /// Records frames after the last result that never entered, as if they had been due now, and those that were still in
  /// the window.
  void recordRest(std::vector<FrameEstimate> dropped, std::vector<FrameEstimate> finals);
  /// Waits until all results are written, as no further one comes, and returns the findings on the own vehicle.
  std::optional<OwnVehicleView> finish();

  const FollowedFrames& followed() const { return followed_; }
  const VehicleMotionNews& vehicleMotion() const { return vehicle_motion_; }
  /// Load of the writing thread, complete after `finish`.
  const WriteQueue::Load& writing() const { return queue_.load(); }

 private:
  RunListeners listeners_;
  bool has_views_;
  Progress progress_;
  Plausibility plausibility_;
  FollowedFrames followed_;
  OwnVehicleNews own_vehicle_;
  VehicleMotionNews vehicle_motion_;
  std::size_t done_ = 0;
  WriteQueue queue_;
};

}  // namespace motorcade
