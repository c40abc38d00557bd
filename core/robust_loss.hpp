#pragma once

namespace motorcade {

/// Influence of a whitened residual on a least-squares problem: rho(r) ~ 0.5 * weight(r) * r^2.
enum class RobustLoss { kNone, kHuber, kCauchy, kTukey };

/// Weight rho'(r) / r of a residual norm r, both relative to `scale` (where the loss leaves the quadratic).
double robustWeight(RobustLoss loss, double residual, double scale);

}  // namespace motorcade
