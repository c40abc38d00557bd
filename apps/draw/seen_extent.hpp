#pragma once

#include <optional>

#include "apps/recorded/recorded_drive.hpp"

namespace motorcade {

/// How far an object was seen, in its body frame: an upright box that is no larger than the cuboid.
struct SeenExtent {
  Eigen::Vector3d least_body, most_body;
  Eigen::Vector3d middle_body() const { return 0.5 * (least_body + most_body); }
};

/// The cuboid, but along an axis whose size is only believed as far as followed points were seen up to this frame, or,
/// where the run did not write them, as far as two standard deviations below the size. Without a cuboid, the points'
/// extent. Empty where there is neither.
std::optional<SeenExtent> seenExtent(const RecordedDrive& drive, std::size_t frame, const ObjectEstimate& object);

}  // namespace motorcade
