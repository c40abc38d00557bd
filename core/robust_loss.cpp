#include "core/robust_loss.hpp"

#include <cmath>

namespace motorcade {

double robustWeight(RobustLoss loss, double residual, double scale) {
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
