#pragma once

#include <string>

#include "core/messages.hpp"
#include "frontend/messages.hpp"

/// What stands in for the message of a stage that threw: the same as the stage gives for a frame without images or
/// without an ego-motion, so that later stages meet nothing new.
namespace motorcade {

/// The frame without its images, rejected for `problem`.
FeaturesPtr rejectedFeatures(const StereoFrame& frame, const std::string& problem);
StereoMatchesPtr noMatches(const FeaturesPtr& features);
OpticalFlowPtr noFlow(const FeaturesPtr& features);
/// No points and no components; the camera moves as `T_previous_now` predicts.
SceneMotionPtr predictedMotion(const StereoFrame& frame, const SE3& T_previous_now);
/// The camera's motion without objects.
FrameMeasurementsPtr cameraAlone(const SceneMotion& motion);
/// Without a pose: who publishes it knows the last pose, and predicts.
EstimatesPtr lostEstimates(const FrameMeasurements& measurements);

}  // namespace motorcade
