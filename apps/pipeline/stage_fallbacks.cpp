#include "apps/pipeline/stage_fallbacks.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/unknown_motion.hpp"

namespace motorcade {
namespace {

template <class Message>
std::shared_ptr<const Message> shared(Message message) {
  return std::make_shared<const Message>(std::move(message));
}

/// Head of a frame that is lost, as a stage failed on which its pose depends.
FrameHead lost(FrameHead head) {
  head.status = FrameStatus::kLost;
  head.cause = FrameCause::kFailed;
  return head;
}

}  // namespace

FeaturesPtr rejectedFeatures(const StereoFrame& frame, const std::string& problem) {
  StereoFrame rejected;
  rejected.head = frame.head;
  rejected.due = frame.due;
  rejected.reject(FrameCause::kFailed, problem);
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

SceneMotionPtr predictedMotion(const StereoFrame& frame, const SceneMotion& before) {
  SceneMotion predicted;
  predicted.head = frame.rejected() ? frame.head : lost(frame.head);
  predicted.head.segment = before.head.segment;
  predicted.odometry = {before.odometry.T_previous_now, unknownMotionCovariance()};
  return shared(std::move(predicted));
}

FrameMeasurementsPtr cameraAlone(const SceneMotion& motion) {
  FrameMeasurements camera;
  camera.head = motion.head.status == FrameStatus::kGood ? lost(motion.head) : motion.head;
  camera.odometry = motion.odometry;
  return shared(std::move(camera));
}

EstimatesPtr lostEstimates(const FrameMeasurements& measurements) {
  Estimates estimates;
  estimates.online.head = lost(measurements.head);
  return shared(std::move(estimates));
}

void rememberExistence(const FrameEstimate& frame, KnownExistence& known) {
  constexpr std::size_t kMostTracks = 1000;
  for (const ObjectEstimate& object : frame.objects) known[object.track] = object.existence_probability;
  while (known.size() > kMostTracks) known.erase(known.begin());
}

EstimatesPtr withoutShapes(const Estimates& estimates, const KnownExistence& known) {
  Estimates without = estimates;
  const auto keepKnown = [&](FrameEstimate& frame) {
    std::erase_if(frame.objects, [&](const ObjectEstimate& object) { return !known.contains(object.track); });
    for (ObjectEstimate& object : frame.objects) object.existence_probability = known.at(object.track);
  };
  keepKnown(without.online);
  std::ranges::for_each(without.settled, keepKnown);
  std::ranges::for_each(without.finals, keepKnown);
  return shared(std::move(without));
}

}  // namespace motorcade
