#pragma once

#include <cstdint>
#include <string>

#include "apps/bridge/messages/ros_objects.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// The objects that were seen in a frame, in the frame `child`, the camera or the vehicle. Predicted ones are left out.
/// The scores of an object's hypotheses sum to the probability that it exists. `first_stamp_ns` is that of the
/// tracker's first result.
ros::Detection3DArray detectionsOf(const Result& result, const std::string& child, std::int64_t first_stamp_ns);

}  // namespace motorcade
