#pragma once

#include <optional>

#include "core/messages.hpp"
#include "frontend/features/feature_preparation.hpp"
#include "frontend/matching/optical_flow.hpp"
#include "frontend/matching/stereo_matcher.hpp"
#include "frontend/segmentation/scene_flow_segmentation.hpp"

namespace motorcade {

/// Searches for the own vehicle in the pairs of a drive, in order, with the stages of a run that find it.
class OwnVehicleSearch {
 public:
  explicit OwnVehicleSearch(const StereoCamera& camera) : prepare_({}), match_({}), follow_({}), segment_({}, camera) {}

  void observe(const StereoFrame& pair);
  /// Empty while nothing is found.
  const std::optional<OwnVehicleView>& found() const { return found_; }

 private:
  FeaturePreparation prepare_;
  StereoMatcher match_;
  OpticalFlowTracker follow_;
  SceneFlowSegmentation segment_;
  std::optional<OwnVehicleView> found_;
};

}  // namespace motorcade
