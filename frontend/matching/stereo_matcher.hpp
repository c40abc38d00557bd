#pragma once

#include <vector>

#include "core/parameters.hpp"
#include "frontend/image/patch_alignment.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Finds the disparity of each corner of the left image. Whole-pixel search over all disparities in images of half
/// size, checked for uniqueness and from right to left; then among the pixels around it, and `refineDisparity`.
/// Features with descriptors (SIFT) are matched by those instead. Stateless; safe to call from several threads.
class StereoMatcher {
 public:
  struct Params {
    double min_disparity_px = 0.5;
    int max_disparity_px = 192;
    int search_columns = 9, search_rows = 5;  // window of the search, odd
    double max_uniqueness_ratio = 0.9;        // best sum of differences over the best elsewhere
    int max_round_trip_px = 1;                // disagreement of left-to-right and right-to-left, at half size
    DisparityParams refinement;
    double sift_max_row_px = 1.5;
    double sift_max_ratio = 0.9;
    double sift_sigma_px = 0.4;
  };
  explicit StereoMatcher(const Params& params);
  StereoMatchesPtr operator()(const FeaturesPtr& features) const;

 private:
  Params params_;
};

std::vector<Parameter> parametersOf(StereoMatcher::Params& params);

}  // namespace motorcade
