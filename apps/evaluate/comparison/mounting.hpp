#pragma once

#include <vector>

#include "core/se3.hpp"

namespace motorcade {

/// Fits the constant X = T_true_cam from the camera of the images to the one whose path the truth gives. The truth of a
/// real drive comes from an inertial unit. Its rotation and lever arm to the camera are calibrated to some hundredths
/// of a radian only. Truth without this error is T_world_true * X.
///
/// The fit is least squares over the drive. It compares the true motions X^-1 (T_i^-1 T_j) X with the estimated ones
/// C_i^-1 C_j, from each frame to the next and from the first frame to each. The latter use positions only, which keep
/// X from following the noise of single frames. A prior on X is needed, as a lever arm shows only where the drive
/// turns. Gauss-Newton linearizes the residual log((X^-1 (T_i^-1 T_j) X)^-1 C_i^-1 C_j) on the right of X, six
/// unknowns.
///
/// Drift that looks like a wrong mounting (a constant turn of the direction of travel) is forgiven, too: read figures
/// with the mounting removed beside those without.
SE3 fitMounting(const std::vector<SE3>& estimate, const std::vector<SE3>& truth);

/// The truth without its mounting error.
std::vector<SE3> withMounting(const std::vector<SE3>& truth, const SE3& T_true_cam);

}  // namespace motorcade
