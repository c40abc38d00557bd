#pragma once

#include <cstdint>

#include "core/vehicle_motion.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// Of stamps, either side of zero: differences of two still are numbers.
inline constexpr std::int64_t kFarthestStamp_ns = std::int64_t{1} << 62;

/// What keeps a sample from being used, as static text; null where nothing does.
const char* problemOf(const VehicleMotion& motion);

VehicleMotionSample sampleOf(const VehicleMotion& motion);

}  // namespace motorcade
