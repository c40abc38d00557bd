#pragma once

#include <cstdint>

#include "core/vehicle_motion.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// The farthest stamp on either side of zero. Differences of two stamps do not overflow.
inline constexpr std::int64_t kFarthestStamp_ns = std::int64_t{1} << 62;

/// The reason why a sample cannot be used, as static text; null where it can.
const char* problemOf(const VehicleMotion& motion);

VehicleMotionSample sampleOf(const VehicleMotion& motion);

}  // namespace motorcade
