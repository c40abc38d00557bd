#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/image.hpp"

namespace motorcade {

/// The brightness of a region of an image, to be found in others as a whole, where its parts are too smooth to be found
/// by themselves. It is compared by normalized cross-correlation over its pixels alone.
class RegionTemplate {
 public:
  /// Pixels at `offsets_px` from the middle, which may lie between pixels. With a scale, as the region is seen from
  /// nearer (> 1) or farther.
  RegionTemplate(const Image& image, const Eigen::Vector2d& middle_px, std::vector<Eigen::Vector2f> offsets_px,
                 double scale = 1);

  /// Where the middle is found, with standard deviations from what the match leaves unexplained.
  struct Match {
    Eigen::Vector2d middle_px, sigma_px;
    double ncc = 0;
  };
  /// The best match within `radius_px` columns and rows of the guess; a radius of 0 leaves its coordinate as guessed.
  /// Empty where that lies at the window's edge, as there may be a better one beyond, and where nothing correlates.
  std::optional<Match> find(const Image& image, const Eigen::Vector2d& guess_px, double scale,
                            const Eigen::Vector2i& radius_px) const;

 private:
  double ncc(const Image& image, const Eigen::Vector2d& middle_px, double scale) const;

  std::vector<Eigen::Vector2f> offsets_px_;
  std::vector<float> values_;  // of zero mean and unit norm
};

}  // namespace motorcade
