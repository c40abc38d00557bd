#pragma once

#include <cstdint>
#include <string>

#include "apps/bridge/messages/ros_objects.hpp"

namespace motorcade {

/// An object's id as a UUID of version 8 (RFC 9562). It has 60 bits of the microseconds of the first stamp of its
/// tracker's drive, and 62 bits of the tracker's id. Objects of different passes have different ones; a drive that is
/// played again has the same.
ros::Uuid uuidOf(std::int64_t object, std::int64_t first_stamp_ns);

/// The usual text, as 0125d8e3-1b2c-8f00-8000-000000000007.
std::string textOf(const ros::Uuid& uuid);

}  // namespace motorcade
