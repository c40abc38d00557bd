#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/parameters.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Finds the disparity of each corner of the left image to a whole pixel. A search over all disparities in the images
/// of half size is checked for uniqueness and from right to left; a search among the pixels around its result follows.
/// Features with descriptors (SIFT) are matched by those instead. Stateless but for its buffers; safe to call from
/// several threads.
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

/// The match of a corner to a fraction of a pixel; empty where there is none. It is computed on demand, as few are
/// asked for.
std::optional<StereoMatch> refinedMatch(const StereoMatches& matches, std::size_t corner);

std::vector<Parameter> parametersOf(StereoMatcher::Params& params);

}  // namespace motorcade
