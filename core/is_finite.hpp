#pragma once

#include "core/se3.hpp"

namespace motorcade {

/// No number of the pose is infinite or undefined.
inline bool isFinite(const SE3& T) { return T.rotation().allFinite() && T.translation().allFinite(); }

}  // namespace motorcade
