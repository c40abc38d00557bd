#pragma once

#include <cmath>

namespace motorcade {

/// Influence of a whitened residual on a least-squares problem: rho(r) ~ 0.5 * weight(r) * r^2.
enum class RobustLoss { kNone, kHuber, kCauchy, kTukey };

/// Weight rho'(r) / r of a residual norm r, both relative to `scale` (where the loss leaves the quadratic).
inline double robustWeight(RobustLoss loss, double residual, double scale) {
  const double r = std::abs(residual), x = r / scale;
  switch (loss) {
    case RobustLoss::kNone:
      return 1.0;
    case RobustLoss::kHuber:
      return x <= 1.0 ? 1.0 : 1.0 / x;
    case RobustLoss::kCauchy:
      return 1.0 / (1.0 + x * x);
    case RobustLoss::kTukey:
      return x < 1.0 ? (1.0 - x * x) * (1.0 - x * x) : 0.0;
  }
  return 1.0;
}

}  // namespace motorcade
