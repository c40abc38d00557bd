#pragma once

#include <vector>

#include "core/parameters.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Finds the disparity of each corner of the left image. A whole-pixel search over all disparities in the images of
/// half size is checked for uniqueness and from right to left. A search among the pixels around its result and
/// `refineDisparity` follow. Features with descriptors (SIFT) are matched by those instead. Stateless but for its
/// buffers; safe to call from several threads.
class StereoMatcher {
 public:
  struct Params {
    double min_disparity_px = 0.5;
    int max_disparity_px = 192;
  };
  explicit StereoMatcher(const Params& params);

  StereoMatchesPtr operator()(const FeaturesPtr& features) const;

 private:
  Params params_;
  mutable ImagePool pool_;  // itself safe for several threads
};

std::vector<Parameter> parametersOf(StereoMatcher::Params& params);

}  // namespace motorcade
