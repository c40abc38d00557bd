#pragma once

#include <optional>
#include <vector>

#include "core/parameters.hpp"
#include "frontend/features/sift_module.hpp"
#include "frontend/messages.hpp"

/// The paper's own front-end: SIFT points matched by their descriptors. Optional; takes about 115 ms per image.
namespace motorcade {

inline constexpr double kSiftSigma_px = 0.4;  // of a point's position and of the disparity of a match

struct SiftPoints {
  std::vector<Corner> corners;
  std::vector<SiftDescriptor> descriptors;
};

/// Detects and describes SIFT points (Lowe 2004). Stateless; safe to call from several threads. OpenCV does it, in a
/// module that the constructor loads where it is not linked in. The constructor throws where there is no module.
class SiftDetector {
 public:
  struct Params {
    int max_points = 1500;
  };
  explicit SiftDetector(const Params& params);
  SiftPoints operator()(const Image& image) const;

 private:
  Params params_;
  decltype(&motorcade_sift_1) detect_;
};

/// The region of the other image, relative to a point, in which its match must lie. Bounds are inclusive.
struct SiftSearchRegion {
  double min_du_px = 0, max_du_px = 0;
  double max_dv_px = 0;
};

/// Matches descriptors: for each point of `from`, the index in `to` of its mutual nearest descriptor in the region, or
/// -1. `max_ratio` bounds the ratio of the nearest to the second nearest distance.
std::vector<int> matchSift(const std::vector<Corner>& from, const std::vector<SiftDescriptor>& from_descriptors,
                           const std::vector<Corner>& to, const std::vector<SiftDescriptor>& to_descriptors,
                           const SiftSearchRegion& region, double max_ratio);

std::vector<Parameter> parametersOf(SiftDetector::Params& params);

}  // namespace motorcade
