#pragma once

#include "backend/joint/residual_levels.hpp"

namespace motorcade {

/// Running noise levels of a body's observations, as factors on the standard deviations that the front-end claims.
class NoiseLevel {
 public:
  NoiseLevel() = default;
  /// Level of another body in the same images: it begins as `known` and learns on its own.
  static NoiseLevel like(const NoiseLevel& known);

  void learn(const ResidualLevels& levels);
  double uv() const;
  double d() const;
  /// Factors of (u, v, d).
  Eigen::Vector3d sigmas() const { return {uv(), uv(), d()}; }
  /// Factor by which variances grow because residuals are not independent, at least 1. It has two parts:
  ///   1 + n rho          n neighbors in the same cell of the image, with the correlation rho (design effect of cluster
  ///                      samples: Kish, Survey Sampling, 1965)
  ///   (1 + c) / (1 - c)  successive residuals of a landmark, with the correlation c (autoregressive process of first
  ///                      order)
  double designEffect(double neighbors_per_view) const;

 private:
  double first_uv2_ = 1, first_d2_ = 1;  // of variances, until enough is seen
  ResidualLevels sums_{};
  double residual_sum_ = 0;  // of squares, as the other sums count them
};

}  // namespace motorcade
