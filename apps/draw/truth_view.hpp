#pragma once

#include "apps/draw/marks.hpp"
#include "apps/draw/top_map.hpp"

namespace motorcade {

/// Paints from above the true paths of camera and movers, and the positions of movers and parked cars.
void paintTruth(Sheet& sheet, const RecordedDrive& drive, std::size_t frame, const TopMap& map);

}  // namespace motorcade
