#pragma once

#include <optional>
#include <vector>

#include "core/parameters.hpp"
#include "frontend/features/corner_detector.hpp"
#include "frontend/features/sift_features.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

enum class DetectorKind { kCorners, kSift };

/// Computes from a stereo pair what stereo matching and optical flow both need: pyramids and points worth following. A
/// rejected pair gives features without images and corners. Stateless but for its buffers; safe to call from several
/// threads.
class FeaturePreparation {
 public:
  struct Params {
    DetectorKind detector = DetectorKind::kCorners;
    CornerDetector::Params corners;
    SiftDetector::Params sift;
  };
  static constexpr int kPyramidLevels = 4;  // the coarsest, an eighth of full size, still shows the texture of vehicles
  explicit FeaturePreparation(const Params& params);
  FeaturesPtr operator()(const StereoFramePtr& frame) const;

 private:
  CornerDetector detect_corners_;
  std::optional<SiftDetector> detect_sift_;  // where it is the detector
  mutable ImagePool pool_;                   // itself safe for several threads
};

std::vector<Parameter> parametersOf(FeaturePreparation::Params& params);

}  // namespace motorcade
