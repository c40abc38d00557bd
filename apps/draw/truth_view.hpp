#pragma once

#include "apps/draw/marks.hpp"
#include "apps/draw/top_map.hpp"

namespace motorcade {

/// From above: the true ways of camera and movers, and where movers and parked cars are.
void paintTruth(Sheet& sheet, const RecordedDrive& drive, std::size_t frame, const TopMap& map);

}  // namespace motorcade
