#pragma once

#include <Eigen/Core>

#include "apps/pipeline/pipeline_result.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Turns the pipeline's results into the caller's, in the axes that were chosen. Takes them in order: it remembers the
/// time of the frame before, for velocities.
class ResultConversion {
 public:
  ResultConversion(Tracker::Axes axes, bool masks);
  Result operator()(const PipelineResult& result);

 private:
  Result::Object object(const ObjectEstimate& object, const SE3& T_world_cam) const;
  void setVelocity(const PipelineResult& result, Result& converted);

  Eigen::Matrix3d R_out_cam_;  // from optical axes to those that were chosen
  bool masks_;
  std::optional<Timestamp> before_;
};

}  // namespace motorcade
