#include "frontend/features/feature_preparation.hpp"

#include <algorithm>
#include <utility>

#include "frontend/image/grain.hpp"
#include "frontend/image/image_pyramid.hpp"

namespace motorcade {
namespace {

/// Share of the least score that suffices in an image of this grain. Blur takes noise as it takes contrast, so fainter
/// corners are as good. Without them, a blur over 9 px leaves too few.
double scoreShare(float grain_gray) {
  constexpr float kBlurredGrain = 0.4F;
  return grain_gray < kBlurredGrain ? 1.0 / 3 : 1;
}

}  // namespace

FeaturePreparation::FeaturePreparation(const Params& params) : detect_corners_(params.corners) {
  requireValid(params.sift);
  if (params.detector == DetectorKind::kSift) detect_sift_.emplace(params.sift);
}

FeaturesPtr FeaturePreparation::operator()(const StereoFramePtr& frame) const {
  Features features;
  features.frame = frame;
  if (frame->rejected()) return std::make_shared<const Features>(std::move(features));

  const Grain left_grain = grainOf(frame->left).value_or(Grain{}),
              right_grain = grainOf(frame->right).value_or(Grain{}), grain = left_grain.with(right_grain);
  const Image left = denoised(frame->left, grain, pool_), right = denoised(frame->right, grain, pool_);
  features.left = buildPyramid(left, kPyramidLevels, pool_);
  features.right = buildPyramid(right, kPyramidLevels, pool_);
  if (!detect_sift_) {
    features.corners = detect_corners_(left, scoreShare(left_grain.smooth_gray), frame->inputs.ignored.get());
  } else {
    SiftPoints in_left = (*detect_sift_)(left), in_right = (*detect_sift_)(right);
    features.corners = std::move(in_left.corners);
    features.descriptors = std::move(in_left.descriptors);
    features.right_corners = std::move(in_right.corners);
    features.right_descriptors = std::move(in_right.descriptors);
  }
  return std::make_shared<const Features>(std::move(features));
}

std::vector<Parameter> parametersOf(FeaturePreparation::Params& params) {
  return {choiceParameter<DetectorKind>("detector", params.detector,
                                        {{"corners", DetectorKind::kCorners}, {"sift", DetectorKind::kSift}},
                                        "corners are fast; SIFT is the paper's detector, a hundred times slower")};
}

}  // namespace motorcade
