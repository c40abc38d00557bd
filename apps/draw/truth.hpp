#pragma once

#include <cstdint>
#include <set>

#include "apps/recorded/recorded_drive.hpp"

namespace motorcade {

/// The labeled objects that move at some time; the others are parked.
std::set<std::int64_t> trueMovers(const RecordedDrive& drive);

}  // namespace motorcade
