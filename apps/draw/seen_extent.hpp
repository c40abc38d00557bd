#pragma once

#include <optional>

#include "apps/recorded/recorded_drive.hpp"

namespace motorcade {

/// The extent in which an object was seen, in its body frame: an upright box that is no larger than the cuboid.
struct SeenExtent {
  Eigen::Vector3d least_body, most_body;
  Eigen::Vector3d middle_body() const { return 0.5 * (least_body + most_body); }
};

/// The cuboid, shortened along axes whose size is uncertain. Such an axis reaches as far as followed points were seen
/// up to this frame. Where the run did not write points, it is two standard deviations shorter than the size. Without a
/// cuboid, the points' extent. Empty where there is neither.
std::optional<SeenExtent> seenExtent(const RecordedDrive& drive, std::size_t frame, const ObjectEstimate& object);

}  // namespace motorcade
