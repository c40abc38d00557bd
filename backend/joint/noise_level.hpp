#pragma once

#include "backend/joint/bundle_factor.hpp"

namespace motorcade {

/// Running noise levels of a body's observations, as factors on the standard deviations that the front-end claims.
class NoiseLevel {
 public:
  void learn(const ResidualLevels& levels);
  double uv() const;
  double d() const;

 private:
  ResidualLevels sums_{};
};

}  // namespace motorcade
