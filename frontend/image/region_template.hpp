#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/image.hpp"

namespace motorcade {

/// Brightness of a region of an image, to be found in others as a whole where its parts are too smooth to be found
/// alone. It is compared by normalized cross-correlation over its pixels alone.
class RegionTemplate {
 public:
  /// Takes the pixels at `offsets_px` from the middle, which may lie between pixels. `scale` shows the region as seen
  /// from nearer (> 1) or farther.
  RegionTemplate(const Image& image, const Eigen::Vector2d& middle_px, std::vector<Eigen::Vector2f> offsets_px,
                 double scale = 1);

  /// Place of the middle, with standard deviations from what the match leaves unexplained.
  struct Match {
    Eigen::Vector2d middle_px, sigma_px;
    double ncc = 0;
  };
  /// Finds the best match within `radius_px` columns and rows of the guess; a radius of 0 leaves its coordinate as
  /// guessed. Empty where the match lies at the window's edge, as there may be a better one beyond, and where nothing
  /// correlates.
  std::optional<Match> find(const Image& image, const Eigen::Vector2d& guess_px, double scale,
                            const Eigen::Vector2i& radius_px) const;

  /// Normalized cross-correlation with the image where the middle lies there.
  double ncc(const Image& image, const Eigen::Vector2d& middle_px, double scale) const;

 private:
  std::vector<Eigen::Vector2f> offsets_px_;
  std::vector<float> values_;  // of zero mean and unit norm
};

}  // namespace motorcade
