#pragma once

#include <optional>
#include <span>
#include <vector>

#include "frontend/matching/corner_lookup.hpp"
#include "frontend/matching/followed_point.hpp"
#include "frontend/matching/young_point_search.hpp"

namespace motorcade {

/// Shift of the whole image beyond the last shifts of its points, as when the camera hits a bump or begins to turn: the
/// median over some points that moved before, which are searched like new ones. `order` holds their indices by place.
/// Empty where few are found.
std::optional<Shift> imageJump(const std::vector<FollowedPoint>& points, std::span<const int> order,
                               const YoungPointSearch& search);

}  // namespace motorcade
