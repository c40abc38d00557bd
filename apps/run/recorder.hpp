#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/pipeline/pipeline_result.hpp"
#include "apps/pipeline/run_listener.hpp"
#include "apps/run/followed_frames.hpp"
#include "apps/run/plausibility.hpp"
#include "apps/watch/own_vehicle_news.hpp"
#include "apps/watch/vehicle_motion_news.hpp"
#include "core/messages.hpp"
#include "io/results/run_folder.hpp"

namespace motorcade {

/// Takes the pipeline's results, in order, into the run folder and to the listeners, and logs oddities.
class Recorder {
 public:
  Recorder(RunFolderWriter& folder, RunListeners listeners, std::size_t frames);

  void record(const PipelineResult& result);
  /// Records frames that never entered. `due` replaces their due times, which are not known.
  void recordDropped(const std::vector<FrameEstimate>& dropped, SteadyTime due);
  void recordFinals(const std::vector<FrameEstimate>& finals);
  /// Ends the recording and returns the findings on the own vehicle.
  std::optional<OwnVehicleView> finish();

  const FollowedFrames& followed() const { return followed_; }
  const VehicleMotionNews& vehicleMotion() const { return vehicle_motion_; }

 private:
  RunFolderWriter& folder_;
  RunListeners listeners_;
  Progress progress_;
  Plausibility plausibility_;
  FollowedFrames followed_;
  OwnVehicleNews own_vehicle_;
  VehicleMotionNews vehicle_motion_;
  std::size_t done_ = 0;
};

}  // namespace motorcade
