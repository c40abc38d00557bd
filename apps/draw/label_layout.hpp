#pragma once

#include <optional>
#include <span>
#include <vector>

#include "apps/canvas/rectangle.hpp"

namespace motorcade {

/// A label of a given size that belongs beside something.
struct LabelRequest {
  Rectangle anchor;
  double width = 0, height = 0;
};

/// Places one label after the other, each where it is nearest to its anchor and hides least of the anchors. No two
/// overlap, and all lie within the area. A label that finds no room is left out.
std::vector<std::optional<Rectangle>> placeLabels(std::span<const LabelRequest> requests, const Rectangle& area);

}  // namespace motorcade
