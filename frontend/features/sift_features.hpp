#pragma once

#include <optional>
#include <vector>

#include "core/parameters.hpp"
#include "frontend/messages.hpp"

/// The paper's own front-end: SIFT points matched by their descriptors. An option; about 115 ms per image.
namespace motorcade {

struct SiftPoints {
  std::vector<Corner> corners;
  std::vector<SiftDescriptor> descriptors;
};

/// Detects and describes SIFT points (Lowe 2004). Stateless; safe to call from several threads.
class SiftDetector {
 public:
  struct Params {
    int max_points = 1500;
    double contrast_threshold = 0.03;
  };
  explicit SiftDetector(const Params& params) : params_(requireValid(params)) {}
  SiftPoints operator()(const Image& image) const;

 private:
  Params params_;
};

/// A region of the other image, relative to a point, in which its match must lie; inclusive bounds.
struct SiftSearchRegion {
  double min_du_px = 0, max_du_px = 0;
  double max_dv_px = 0;
};

/// For each point of `from` the index in `to` of its mutual nearest descriptor within the region, -1 when there is
/// none. `max_ratio` bounds the distance over that of the second nearest.
std::vector<int> matchSift(const std::vector<Corner>& from, const std::vector<SiftDescriptor>& from_descriptors,
                           const std::vector<Corner>& to, const std::vector<SiftDescriptor>& to_descriptors,
                           const SiftSearchRegion& region, double max_ratio);

std::vector<Parameter> parametersOf(SiftDetector::Params& params);

}  // namespace motorcade
