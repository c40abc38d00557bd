#include "apps/pipeline/stage_fallbacks.hpp"

#include <memory>
#include <utility>

#include "core/unknown_motion.hpp"

namespace motorcade {
namespace {

template <class Message>
std::shared_ptr<const Message> shared(Message message) {
  return std::make_shared<const Message>(std::move(message));
}

}  // namespace

FeaturesPtr rejectedFeatures(const StereoFrame& frame, const std::string& problem) {
  StereoFrame rejected;
  rejected.frame = frame.frame;
  rejected.stamp = frame.stamp;
  rejected.due = frame.due;
  rejected.problem = problem;
  Features features;
  features.frame = shared(std::move(rejected));
  return shared(std::move(features));
}

StereoMatchesPtr noMatches(const FeaturesPtr& features) {
  StereoMatches none{.features = features, .of_corner = {}};
  none.of_corner.resize(features->corners.size());
  return shared(std::move(none));
}

OpticalFlowPtr noFlow(const FeaturesPtr& features) {
  return shared(OpticalFlow{.features = features, .observations = {}});
}

SceneMotionPtr predictedMotion(const StereoFrame& frame, const SE3& T_previous_now) {
  SceneMotion predicted;
  predicted.frame = frame.frame;
  predicted.stamp = frame.stamp;
  predicted.status = frame.rejected() ? FrameStatus::kRejected : FrameStatus::kLost;
  predicted.cause = frame.rejected() ? FrameCause::kUnusable : FrameCause::kFailed;
  predicted.T_previous_now = T_previous_now;
  predicted.odometry_covariance = unknownMotionCovariance();
  return shared(std::move(predicted));
}

FrameMeasurementsPtr cameraAlone(const SceneMotion& motion) {
  FrameMeasurements camera;
  camera.frame = motion.frame;
  camera.stamp = motion.stamp;
  camera.status = motion.status == FrameStatus::kGood ? FrameStatus::kLost : motion.status;
  camera.cause = motion.status == FrameStatus::kGood ? FrameCause::kFailed : motion.cause;
  camera.segment = motion.segment;
  camera.T_previous_now = motion.T_previous_now;
  camera.odometry_covariance = motion.odometry_covariance;
  return shared(std::move(camera));
}

EstimatesPtr lostEstimates(const FrameMeasurements& measurements) {
  Estimates lost;
  lost.online.frame = measurements.frame;
  lost.online.stamp = measurements.stamp;
  lost.online.status = FrameStatus::kLost;
  return shared(std::move(lost));
}

}  // namespace motorcade
