#include "frontend/features/feature_preparation.hpp"

#include <utility>

#include "frontend/image/image_pyramid.hpp"

namespace motorcade {

FeaturePreparation::FeaturePreparation(const Params& params)
    : params_(params), detect_corners_(params.corners), detect_sift_(params.sift) {}

FeaturesPtr FeaturePreparation::operator()(const StereoFramePtr& frame) const {
  Features features;
  features.frame = frame;
  if (frame->rejected()) return std::make_shared<const Features>(std::move(features));

  features.left = buildPyramid(frame->left, kPyramidLevels, pool_);
  features.right = buildPyramid(frame->right, kPyramidLevels, pool_);
  if (params_.detector == DetectorKind::kCorners) {
    features.corners = detect_corners_(frame->left);
  } else {
    SiftPoints left = detect_sift_(frame->left), right = detect_sift_(frame->right);
    features.corners = std::move(left.corners);
    features.descriptors = std::move(left.descriptors);
    features.right_corners = std::move(right.corners);
    features.right_descriptors = std::move(right.descriptors);
  }
  return std::make_shared<const Features>(std::move(features));
}

std::vector<Parameter> parametersOf(FeaturePreparation::Params& params) {
  return {choiceParameter<DetectorKind>("detector", params.detector,
                                        {{"corners", DetectorKind::kCorners}, {"sift", DetectorKind::kSift}},
                                        "corners are fast; SIFT is the paper's detector, a hundred times slower")};
}

}  // namespace motorcade
