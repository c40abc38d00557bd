#pragma once

#include <optional>

#include <Eigen/Core>

#include "apps/pipeline/pipeline_result.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Turns the pipeline's results into the caller's, in the axes that were chosen. Takes them in order: it remembers
/// since when a motion is measured.
class ResultConversion {
 public:
  ResultConversion(Tracker::Axes axes, bool masks);
  /// A result for which there is no memory tells so, without objects.
  Result operator()(const PipelineResult& result);
  /// A frame that has left the smoothing window: without velocity, masks and latency. May throw std::bad_alloc.
  Result final(const FrameEstimate& estimate) const;

 private:
  Result cameraOf(const FrameEstimate& estimate) const;
  void setObjects(const PipelineResult& result, Result& converted) const;
  Result::Object object(const ObjectEstimate& object, const SE3& T_world_cam) const;
  void setVelocity(const FrameMeasurements& measured, Result& converted);

  Eigen::Matrix3d R_out_cam_;  // from optical axes to those that were chosen
  bool masks_;
  std::optional<Timestamp> before_, seen_;  // the last frame, and the last one that was looked at
  SE3 T_seen_before_;
};

}  // namespace motorcade
