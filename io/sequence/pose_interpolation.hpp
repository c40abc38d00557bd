#pragma once

#include <vector>

#include "core/se3.hpp"
#include "core/timestamp.hpp"

namespace motorcade {

/// The pose at a time between, or a little outside, the given ones, of which there are at least two. Position and
/// attitude each change at a constant rate.
SE3 poseAt(Timestamp stamp, const std::vector<SE3>& poses, const std::vector<Timestamp>& stamps);

}  // namespace motorcade
