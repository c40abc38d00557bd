#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "apps/pipeline/pipeline_result.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Turns the pipeline's results into the caller's, in the chosen axes. Takes them in order: it remembers the frame at
/// which a motion begins.
class ResultConversion {
 public:
  ResultConversion(Tracker::Axes axes, bool masks);
  /// Converts a result. Where memory runs out, the result says so and has no objects.
  Result operator()(const PipelineResult& result);
  /// Converts a frame that has left the smoothing window: without velocity, masks and latency. May throw
  /// std::bad_alloc.
  Result final(const FrameEstimate& estimate);
  /// Starts ids that no object of an earlier drive has.
  void startIdsAt(std::int64_t first_id) { first_id_ = next_id_ = first_id; }
  std::int64_t nextId() const { return next_id_; }

 private:
  Result cameraOf(const FrameEstimate& estimate) const;
  void setObjects(const PipelineResult& result, Result& converted);
  Result::Object object(const ObjectEstimate& object, const SE3& T_world_cam);
  void setVelocity(const FrameMeasurements& measured, Result& converted);

  Eigen::Matrix3d R_out_cam_;  // from optical axes to those that were chosen
  bool masks_;
  std::int64_t first_id_ = 0, next_id_ = 0;
  std::optional<Timestamp> before_, seen_;  // the last frame, and the last one that was looked at
  SE3 T_seen_before_;
};

}  // namespace motorcade
