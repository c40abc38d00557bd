#pragma once

#include <vector>

#include "core/se3.hpp"

namespace motorcade {

/// The constant X = T_true_cam between the camera whose path the truth tells and the one that the images come from: the
/// truth of a real drive is that of an inertial unit, whose rotation and lever arm to the camera are calibrated to some
/// hundredths of a radian only. Truth without this error is T_world_true * X.
///
/// Least squares over the drive: the motions that the truth says the camera made, X^-1 (T_i^-1 T_j) X, against the
/// estimated ones C_i^-1 C_j, from each frame to the next, and from the first frame to each (positions, which keep X
/// from following the noise of single frames), with a prior on X, as a lever arm shows only where the drive turns. The
/// residual log((X^-1 (T_i^-1 T_j) X)^-1 C_i^-1 C_j) is linearized on the right of X, six unknowns, by Gauss-Newton.
///
/// An estimate whose own drift looks like a wrong mounting (a constant turn of its direction of travel) is forgiven for
/// it: read figures with the mounting removed beside those without.
SE3 fitMounting(const std::vector<SE3>& estimate, const std::vector<SE3>& truth);

/// The truth without its mounting error.
std::vector<SE3> withMounting(const std::vector<SE3>& truth, const SE3& T_true_cam);

}  // namespace motorcade
