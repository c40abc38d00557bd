#pragma once

#include <map>
#include <string>

#include "core/messages.hpp"
#include "frontend/messages.hpp"

/// Messages that replace those of a stage that threw. They equal the stage's messages for a frame without images or
/// without an ego-motion, so that later stages meet nothing new.
namespace motorcade {

/// The frame without its images, rejected for `problem`.
FeaturesPtr rejectedFeatures(const StereoFrame& frame, const std::string& problem);
StereoMatchesPtr noMatches(const FeaturesPtr& features);
OpticalFlowPtr noFlow(const FeaturesPtr& features);
/// No points and no components; the camera moves as in the frame before, in the same segment.
SceneMotionPtr predictedMotion(const StereoFrame& frame, const SceneMotion& before);
/// The camera's motion without objects.
FrameMeasurementsPtr cameraAlone(const SceneMotion& motion);
/// Estimates without a pose. The publisher knows the last pose, and predicts.
EstimatesPtr lostEstimates(const FrameMeasurements& measurements);

/// Each track's probability of existence when the shapes were last estimated.
using KnownExistence = std::map<TrackId, double>;

/// Adds the newest frame's objects to `known`, which keeps the youngest thousand tracks.
void rememberExistence(const FrameEstimate& frame, KnownExistence& known);
/// The estimates without shapes. Objects keep the probability of existence that is known of them; others are dropped,
/// because only the shapes tell whether they are there.
EstimatesPtr withoutShapes(const Estimates& estimates, const KnownExistence& known);

}  // namespace motorcade
