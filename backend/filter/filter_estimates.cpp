#include "backend/filter/filter_estimates.hpp"

namespace motorcade {

FrameEstimate cameraEstimate(const FrameMeasurements& measurements, const CameraPath& path, int motion_frames) {
  const FrameId frame = measurements.head.frame;
  const CameraPath::Camera& camera = *path.find(frame);
  CameraCovariances covariances{.motion = path.covarianceSince(FrameId{frame.value - motion_frames}, frame),
                                .pose = {}};
  if (measurements.head.segment == 0) covariances.pose = camera.pose_covariance;
  return {
      .head = measurements.head, .T_world_cam = camera.T_world_cam, .camera_covariances = covariances, .objects = {}};
}

ObjectEstimate objectEstimate(const ObjectObservation& observation, const ObjectFilter& filter) {
  return {.track = observation.track,
          .state = observation.state,
          .T_world_body = filter.pose(),
          .velocity_world_mps = filter.velocityWorld_mps(),
          .speed_sigma_mps = filter.speedSigma_mps(),
          .yaw_rate_radps = filter.yawRate_radps(),
          .yaw_rate_sigma_radps = filter.yawRateSigma_radps(),
          .points = observation.points,
          .box = observation.box,
          .covariance = filter.poseCovariance()};
}

}  // namespace motorcade
